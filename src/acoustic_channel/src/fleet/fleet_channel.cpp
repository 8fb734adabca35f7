#include "acoustic_channel/fleet/fleet_channel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

/// Runs that begin within one hour count from the same time 0. So the grid of steps and the draws
/// do not depend on which message arrived first.
constexpr TimeNs kHour = 3'600'000'000'000;

/// Most packets of a vehicle that wait for later steps.
constexpr std::size_t kMostWaiting = 10'000;

TimeNs Nanoseconds(double s) { return static_cast<TimeNs>(std::llround(s * 1e9)); }

MotionTrack::Options LimitsOf(const FleetPatience& p) {
  return {Nanoseconds(p.odometry_s), Nanoseconds(p.silent_after_s), p.has_velocity};
}

}  // namespace

FleetChannel::FleetChannel(const NetworkConfig& network, const FleetPatience& patience,
                           FleetListener* listener)
    : period_(network.run.decision_period()),
      lag_(Nanoseconds(patience.lag_s)),
      patience_(Nanoseconds(patience.odometry_s)),
      silent_after_(Nanoseconds(patience.silent_after_s)),
      seed_(network.run.seed),
      channel_(MakeChannel(network.channel, network.run)),
      listener_(listener),
      tracks_(static_cast<std::size_t>(network.run.agents), MotionTrack(LimitsOf(patience))),
      waiting_(tracks_.size()),
      present_(tracks_.size(), false),
      positions_(tracks_.size()),
      velocities_(tracks_.size()) {
  channel_->Observe(listener);
}

void FleetChannel::Restart() {
  for (MotionTrack& track : tracks_) track.Clear();
  for (auto& queue : waiting_) queue.clear();
  asked_.clear();
  begun_ = false;
  first_ = -1;
  present_.assign(tracks_.size(), false);
}

FleetChannel::Word FleetChannel::Move(int vehicle, TimeNs stamp, const Motion& motion) {
  if (begun_ && stamp <= closed_ - patience_) return Word::kLate;
  if (!tracks_[static_cast<std::size_t>(vehicle)].Add(stamp, motion)) return Word::kRepeated;
  if (first_ < 0 || stamp < first_) first_ = stamp;
  return Word::kCounts;
}

FleetChannel::Word FleetChannel::Offer(const Transmission& packet) {
  channel_->CheckOrThrow(packet);
  auto& queue = waiting_[static_cast<std::size_t>(packet.source)];
  if (queue.size() >= kMostWaiting) {
    throw UserError("packet: " + std::to_string(kMostWaiting) +
                    " packets of this vehicle are already waiting for their steps");
  }
  if (first_ < 0 || packet.stamp < first_) first_ = packet.stamp;
  const auto later =
      std::upper_bound(queue.begin(), queue.end(), packet.stamp,
                       [](TimeNs t, const Offered& o) { return t < o.packet.stamp; });
  const auto first = packet.payload.data;
  queue.insert(later, {packet, {first, first + packet.payload.size}});
  return begun_ && packet.stamp <= closed_ ? Word::kLate : Word::kCounts;
}

void FleetChannel::Ping(int source, int destination, TimeNs timeout, std::uint32_t tag) {
  asked_.push_back({source, destination, timeout, tag});
}

/// The time up to which, at the time `now`, all messages have arrived or have been waited for long
/// enough.
TimeNs FleetChannel::Settled(TimeNs now) const {
  const TimeNs complete = now - lag_;  // no message up to this time is expected any more
  TimeNs settled = complete;
  for (const MotionTrack& track : tracks_) {
    // A step between two samples needs both of them and no third one between them. So the newest
    // sample is not enough for later times.
    const auto newest = track.NewestUntil(complete);
    const bool silent = !newest || (begun_ && *newest + silent_after_ < closed_);
    if (!silent) settled = std::min(settled, std::max(*newest, complete - patience_));
  }
  return settled;
}

void FleetChannel::Finish() {
  TimeNs last = -1;
  for (const MotionTrack& track : tracks_) last = std::max(last, track.newest().value_or(-1));
  CloseUntil(last);
}

void FleetChannel::CloseUntil(TimeNs until) {
  if (!begun_) {
    if (first_ < 0 || until < first_) return;
    Begin();
  }
  while (next_ <= until) Close();
}

void FleetChannel::Begin() {
  begun_ = true;
  start_ = first_ / kHour * kHour;
  next_ = (first_ + period_ - 1) / period_ * period_;
  closed_ = next_ - period_;
  channel_->Reset(seed_, 0);
  present_.assign(tracks_.size(), true);
  positions_.assign(tracks_.size(), {});
  velocities_.assign(tracks_.size(), {});
  listener_->OnBegin(start_);
}

void FleetChannel::Close() {
  Place();
  Collect();
  const TimeNs now = next_ - start_;
  Ask(now);
  channel_->Step(now, static_cast<std::uint32_t>(next_ / period_), positions_, velocities_,
                 offers_);
  for (int i = 0; i < vehicles(); ++i) {
    received_.clear();
    channel_->Deliver(i, now, &received_);
    if (!received_.empty()) listener_->OnReceptions(i, received_);
  }
  closed_ = next_;
  next_ += period_;
}

void FleetChannel::Ask(TimeNs now) {
  for (const Asked& a : asked_) {
    if (!present(a.source)) {
      listener_->OnPingRefused(a.tag, "the vehicle that asks is not present: it has no odometry");
      continue;
    }
    try {
      channel_->Ping(a.source, a.destination, now, a.timeout, a.tag);
    } catch (const UserError& error) {
      listener_->OnPingRefused(a.tag, error.what());
    }
  }
  asked_.clear();
}

/// Sets the positions of all vehicles, and which vehicles are absent.
void FleetChannel::Place() {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const auto motion = tracks_[i].At(next_);
    tracks_[i].ForgetBefore(next_);
    if (motion.has_value() != present_[i]) {
      present_[i] = motion.has_value();
      channel_->SetPresent(static_cast<int>(i), present_[i]);
    }
    if (!motion) continue;
    positions_[i] = motion->p_W;
    velocities_[i] = motion->v_W;
  }
}

/// Collects the packets of this step.
void FleetChannel::Collect() {
  sending_.clear();
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    auto& queue = waiting_[i];
    while (!queue.empty() && queue.front().packet.stamp <= next_) {
      Offered offered = std::move(queue.front());
      queue.pop_front();
      offered.packet.payload = ViewOf(offered.bytes);
      if (!present_[i]) {
        listener_->OnAbsent(offered.packet);
        continue;
      }
      const bool one_a_step = !channel_->continuous();
      if (one_a_step && !sending_.empty() && sending_.back().packet.source == static_cast<int>(i)) {
        Discard(sending_.back());  // like a modem that has room for one packet
        sending_.back() = std::move(offered);
      } else {
        sending_.push_back(std::move(offered));
      }
    }
  }
  offers_.clear();
  for (const Offered& offered : sending_) Hand(offered);
}

void FleetChannel::Discard(const Offered& offered) const {
  PacketInfo info;
  info.source = offered.packet.source;
  info.destination = offered.packet.destination;
  info.tag = offered.packet.tag;
  info.bytes = offered.bytes.size();
  info.offered = offered.packet.stamp - start_;
  info.generation = offered.packet.generation - start_;
  listener_->OnDiscarded(info, DropReason::kQueue, next_ - start_);
}

void FleetChannel::Hand(const Offered& offered) {
  // The bytes keep their place in memory if their owner is moved.
  Transmission packet = offered.packet;
  const TimeNs stamp = channel_->continuous() ? std::max(packet.stamp, closed_ + 1) : next_;
  packet.stamp = stamp - start_;
  packet.generation -= start_;
  offers_.push_back(packet);
}

}  // namespace stg::acoustics

#include "acoustic_channel/network/network.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "acoustic_channel/network/water_medium.hpp"
#include "auv_common/numbers/random.hpp"
#include "network_impl.hpp"

namespace stg::acoustics {
namespace {

constexpr std::size_t kEventsPerNode = 64;

bool Finite(const Vec3<double>& v) { return (v.x + v.y + v.z) * 0.0 == 0.0; }

}  // namespace

Network::Impl::Impl(const ChannelConfig& config, const RunConfig& run,
                    std::unique_ptr<Medium> medium)
    : count_(run.agents),
      talkers_(run.agents - run.transponders),
      timekeepers_(run.timekeepers),
      max_payload_(LongestPayload(config.physical.modem, run.agents)),
      config_(config.physical.modem),
      medium_(std::move(medium)),
      access_(MakeMediumAccess(config, run)),
      events_(kEventsPerNode * static_cast<std::size_t>(run.agents)),
      table_(run.agents) {
  const auto n = static_cast<std::size_t>(count_);
  const std::size_t waiting =
      config_.queue == QueuePolicy::kFifo ? static_cast<std::size_t>(config_.queue_length) : 1;
  for (ModemProfile& profile : MakeProfiles(config.physical.modem, count_)) {
    Node& node = nodes_.emplace_back();
    node.profile = std::move(profile);
    node.queue.reserve(waiting + 1);
    node.active.reserve(4 * n);
    node.delivered.reserve(4 * n);
  }
  packets_.Reserve(n * (waiting + 4));
  arrivals_.Reserve(4 * n * n);
  moves_.Reserve(n);
  Reset(0, 0);
}

void Network::Impl::Reset(std::uint64_t seed, std::uint32_t episode) {
  seed_ = seed;
  episode_ = episode;
  now_ = -1;
  events_.Clear();
  packets_.Clear();
  arrivals_.Clear();
  moves_.Clear();
  payloads_.Clear();
  table_.Reset(0);
  medium_->Reset(seed, episode);
  access_->Reset(seed, episode);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Node fresh;
    Node& n = nodes_[i];
    n.queue.clear();
    n.active.clear();
    n.delivered.clear();
    std::swap(fresh.profile, n.profile);
    std::swap(fresh.waveforms, n.waveforms);
    std::swap(fresh.queue, n.queue);
    std::swap(fresh.active, n.active);
    std::swap(fresh.delivered, n.delivered);
    n = std::move(fresh);
    const int id = static_cast<int>(i);
    if (id >= talkers_ - timekeepers_ && id < talkers_) continue;
    Random random(seed, Stream::kClock, episode, 0, static_cast<std::uint32_t>(i));
    n.clock_offset_s = config_.clock_offset_std_s * random.Normal();
    n.clock_rate = config_.clock_drift_std_ppm * 1e-6 * random.Normal();
  }
}

void Network::Impl::Advance(TimeNs t) {
  while (events_.Has(t)) Happen(events_.Pop());
  now_ = std::max(now_, t);
}

void Network::Impl::Happen(const Event& e) {
  switch (e.kind()) {
    case EventKind::kPresence:
      SetPresent(e.source(), e.t, moves_[e.index].present);
      moves_.Remove(e.index);
      break;
    case EventKind::kMove:
      SetMotion(e.source(), e.t, moves_[e.index].motion);
      moves_.Remove(e.index);
      break;
    case EventKind::kArrivalEnd:
      End(e.index, e.t);
      break;
    case EventKind::kSendEnd:
      EndSend(e.source(), e.t);
      break;
    case EventKind::kOffer:
      Queue(e.index, e.t);
      break;
    case EventKind::kReply:
      Reply(e.source(), e.index, e.t);
      break;
    case EventKind::kSend:
      TrySend(e.source(), e.t);
      break;
    case EventKind::kArrivalBegin:
      Begin(e.index, e.t);
      break;
    case EventKind::kAcquire:
      Acquire(e.receiver(), e.t);
      break;
    case EventKind::kNoise:
      ChangeNoise(e.receiver(), e.index, e.t);
      break;
    case EventKind::kTimeout: {
      const Ping& ping = At(e.source()).ping;
      if (ping.open && ping.number == static_cast<std::uint32_t>(e.index)) {
        EndPing(e.source(), e.t, false);
      }
      break;
    }
  }
}

NodeMotion Network::Impl::Motion(const Node& n, TimeNs t) const {
  return {n.motion.p_W + n.motion.v_W * Seconds(t - n.moved), n.motion.v_W};
}

void Network::Impl::SetMotion(int node, TimeNs t, const NodeMotion& motion) {
  At(node).motion = motion;
  At(node).moved = t;
}

void Network::Impl::SetPresent(int node, TimeNs t, bool present) {
  Node& n = At(node);
  if (n.present == present) return;
  n.present = present;
  if (present) {
    n.present_since = t;
    return;
  }
  n.present_ns += t - n.present_since;
  for (const int packet : n.queue) Discard(packet, DropReason::kLeft, t);
  n.queue.clear();
  if (n.request != kNone) Discard(n.request, DropReason::kLeft, t);
  n.request = kNone;
  if (n.ping.open) EndPing(node, t, false);
  const int locked = n.locked;
  Unlock(&n, t);
  for (const int arrival : n.active) {
    Arrival& a = arrivals_[arrival];
    a.candidate = false;
    if (a.open) Drop(&a, DropReason::kLeft, 0.0, 0.0, 0.0);
  }
  if (locked != kNone) BreakLock(arrivals_[locked], DropReason::kLeft, t);
}

double Network::Impl::EnergyJ(const Node& n, TimeNs t) const {
  const TimeNs sent = Sent(n, t);
  const TimeNs received = n.received_ns + (n.locked != kNone ? t - n.lock_begin : 0);
  const TimeNs present = n.present_ns + (n.present ? t - n.present_since : 0);
  const TimeNs idle = std::max<TimeNs>(0, present - sent - received);
  return n.profile.transmit_w * Seconds(sent) + n.profile.receive_w * Seconds(received) +
         n.profile.idle_w * Seconds(idle);
}

Network::Network(const ChannelConfig& config, const RunConfig& run, std::unique_ptr<Medium> medium)
    : impl_(std::make_unique<Impl>(config, run, std::move(medium))) {}
Network::Network(const ChannelConfig& config, const RunConfig& run, LineOfSight line_of_sight)
    : Network(
          config, run,
          std::make_unique<WaterMedium>(config.physical, run.agents, std::move(line_of_sight))) {}
Network::~Network() = default;

void Network::Reset(std::uint64_t seed, std::uint32_t episode) { impl_->Reset(seed, episode); }
void Network::Observe(PacketObserver* observer) { impl_->observer_ = observer; }
int Network::nodes() const { return impl_->count_; }
TimeNs Network::now() const { return impl_->now_; }
std::size_t Network::max_payload() const { return impl_->max_payload_; }
const ModemProfile& Network::profile(int node) const { return impl_->At(node).profile; }
const ChannelTotals& Network::totals() const { return impl_->table_.totals(); }
const LinkTable& Network::table() const { return impl_->table_; }
void Network::StartStatistics(TimeNs t) { impl_->table_.Reset(t); }

void Network::Move(int node, TimeNs t, const Vec3<double>& p_W, const Vec3<double>& v_W) {
  if (!Finite(p_W) || !Finite(v_W)) throw std::invalid_argument("Network::Move: not finite");
  if (t == impl_->now_) {
    impl_->SetMotion(node, t, {p_W, v_W});
    return;
  }
  if (t < impl_->now_) throw std::invalid_argument("Network::Move: in the past");
  const int move = impl_->moves_.Add({{p_W, v_W}, true});
  impl_->events_.Push(t, EventKind::kMove, node, 0, move);
}

void Network::Offer(const Transmission& packet) {
  if (packet.stamp < impl_->now_) throw std::invalid_argument("Network::Offer: in the past");
  if (packet.kind == PacketKind::kPing || packet.kind == PacketKind::kReply) {
    throw std::invalid_argument("Network::Offer: use Ping for a ping");
  }
  const int made = impl_->MakePacket(packet, packet.kind);
  if (packet.stamp == impl_->now_) {
    impl_->Queue(made, packet.stamp);
  } else {
    impl_->events_.Push(packet.stamp, EventKind::kOffer, packet.source, 0, made);
  }
}

void Network::SetPresent(int node, TimeNs t, bool present) {
  if (t == impl_->now_) {
    impl_->SetPresent(node, t, present);
    return;
  }
  if (t < impl_->now_) throw std::invalid_argument("Network::SetPresent: in the past");
  impl_->events_.Push(t, EventKind::kPresence, node, 0, impl_->moves_.Add({{}, present}));
}

void Network::Ping(int source, int destination, TimeNs t, TimeNs timeout, std::uint32_t tag) {
  if (t < impl_->now_) throw std::invalid_argument("Network::Ping: in the past");
  const std::uint8_t nothing = 0;
  Transmission request;
  request.source = source;
  request.destination = destination;
  request.stamp = request.generation = t;
  request.tag = tag;
  request.payload = {&nothing, 1};
  const int made = impl_->MakePacket(request, PacketKind::kPing);
  impl_->packets_[made].deadline = t + timeout;
  impl_->events_.Push(t, EventKind::kOffer, source, 0, made);
}

void Network::Advance(TimeNs t) { impl_->Advance(t); }
TimeNs Network::next() const {
  return impl_->events_.empty() ? kNever : std::max(impl_->events_.first(), impl_->now_);
}
bool Network::Cancel(int source, std::uint32_t tag) {
  return impl_->Cancel(source, tag, std::max<TimeNs>(impl_->now_, 0));
}
void Network::SetWaveforms(int node, std::vector<std::string> waveforms) {
  impl_->At(node).waveforms = std::move(waveforms);
}

void Network::Take(int receiver, TimeNs until, std::vector<Reception>* out) {
  auto& delivered = impl_->At(receiver).delivered;
  std::size_t taken = 0;
  while (taken < delivered.size() && delivered[taken].reception.arrival <= until) {
    Impl::Delivered& d = delivered[taken++];
    impl_->payloads_.Release(d.payload);
    out->push_back(d.reception);
    out->back().payload = impl_->payloads_.at(d.payload);
  }
  delivered.erase(delivered.begin(), delivered.begin() + static_cast<std::ptrdiff_t>(taken));
}

void Network::Forget() {
  for (Impl::Node& n : impl_->nodes_) {
    for (const Impl::Delivered& d : n.delivered) impl_->payloads_.Release(d.payload);
    n.delivered.clear();
  }
  Recycle();
}

void Network::Recycle() { impl_->payloads_.Recycle(); }

NodeMotion Network::Motion(int node, TimeNs t) const { return impl_->Motion(impl_->At(node), t); }
bool Network::present(int node) const { return impl_->At(node).present; }
double Network::EnergyJ(int node, TimeNs t) const { return impl_->EnergyJ(impl_->At(node), t); }
double Network::SentS(int node, TimeNs t) const { return Seconds(impl_->Sent(impl_->At(node), t)); }
double Network::ClockS(int node, TimeNs t) const {
  return Seconds(t) + impl_->ClockError(impl_->At(node), t);
}

Hearing Network::Expect(int source, int destination, TimeNs t) const {
  return impl_->medium_->Expect(Motion(source, t), Motion(destination, t), profile(source));
}

double Network::SoundSpeed(int node) const {
  return impl_->medium_->SoundSpeed(Motion(node, std::max<TimeNs>(now(), 0)).p_W);
}

double Network::ExpectedLoss(int source, int destination, TimeNs t) const {
  const ModemProfile& p = profile(destination);
  if (profile(source).waveform != p.waveform) return 1.0;
  if (p.ideal) return 0.0;
  const double speed = Norm(Motion(destination, t).v_W);
  const double noise_db = impl_->medium_->Noise(destination, t, speed, p).quiet_level_db;
  const double sinr_db = Expect(source, destination, t).level_db - noise_db;
  if (sinr_db < p.acquisition_db) return 1.0;
  const double bits = 8.0 * static_cast<double>(p.frames(max_payload()) * p.frame_bytes);
  return 1.0 - std::exp(p.errors.LogSuccess(sinr_db - p.implementation_db, bits));
}

}  // namespace stg::acoustics

#pragma once

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <vector>

#include "acoustic_channel/access/outbox.hpp"
#include "acoustic_channel/channel/channel.hpp"
#include "acoustic_channel/models/link_values.hpp"
#include "acoustic_channel/modem/payload_pool.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::acoustics {

/// A channel whose links are independent of each other, so that the fate of a packet is known
/// when it is sent. Cost: one evaluation of the formula and one draw per packet and receiver.
///
/// Formula has, for T = double and T = Pack with the same result bit for bit,
///   T DelayS(const T& d) const;                                travel time over d metres [s]
///   LinkValues<T> At(const T& d, const T& age_s) const;        loss, and quality at that age
/// and
///   bool Reaches(double d) const;     false: nothing arrives at this distance
///   bool ages() const;                the quality depends on the age; it is 0 at first
///   double freshness_s() const;       see LinkEstimator
template <class Formula>
class IndependentLinks : public Channel {
 public:
  /// Throws UserError for an unknown medium access.
  IndependentLinks(const Formula& formula, const ChannelConfig& config, const RunConfig& run)
      : nodes_(run.agents),
        padded_((run.agents + kLanes - 1) / kLanes * kLanes),
        formula_(formula),
        outbox_(config, run),
        table_(run.agents),
        pending_(static_cast<std::size_t>(nodes_)) {
    for (std::vector<double>* v :
         {&x_, &y_, &z_, &vx_, &vy_, &vz_, &distance_, &loss_, &quality_, &delay_s_, &closing_}) {
      v->assign(static_cast<std::size_t>(padded_), 0.0);
    }
    present_.assign(static_cast<std::size_t>(nodes_), 1);
    for (auto& queue : pending_) queue.reserve(static_cast<std::size_t>(nodes_));
    ripe_.reserve(static_cast<std::size_t>(nodes_));
  }

  void Observe(PacketObserver* observer) override { observer_ = observer; }

  void SetPresent(int node, bool present) override {
    const auto i = static_cast<std::size_t>(node);
    present_[i] = present ? 1 : 0;
    absent_ = static_cast<int>(std::count(present_.begin(), present_.end(), 0));
    if (present) return;
    outbox_.Drop(node, [this](const Transmission& packet) { Discard(packet, DropReason::kLeft); });
    for (const Pending& pending : pending_[i]) {
      const Reception& r = pending.reception;
      table_.Drop(r.source, node, DropReason::kLeft);
      if (observer_ != nullptr) Tell(pending, DropReason::kLeft);
      payloads_.Release(pending.payload);
    }
    pending_[i].clear();
  }

  int nodes() const override { return nodes_; }
  std::size_t max_payload() const override { return kLargestFrame; }
  bool Due(int node, TimeNs t) override { return outbox_.Due(node, t); }

  void Reset(std::uint64_t seed, std::uint32_t episode) override {
    seed_ = seed;
    episode_ = episode;
    started_ = false;
    outbox_.Reset(seed, episode);
    payloads_.Clear();
    table_.Reset(0);
    for (auto& queue : pending_) queue.clear();
    std::fill(present_.begin(), present_.end(), 1);
    absent_ = 0;
    now_ = 0;
    for (std::vector<double>* v : {&x_, &y_, &z_, &vx_, &vy_, &vz_}) {
      std::fill(v->begin(), v->end(), 0.0);
    }
  }

  void Step(TimeNs t, std::uint32_t step, const std::vector<Vec3<double>>& p_W,
            const std::vector<Vec3<double>>& v_W,
            const std::vector<Transmission>& offered) override {
    assert(static_cast<int>(p_W.size()) == nodes_ && static_cast<int>(v_W.size()) == nodes_);
    if (!started_) {
      table_.Reset(t);
      started_ = true;
    }
    now_ = t;
    payloads_.Recycle();
    Place(p_W, v_W);
    if (observer_ != nullptr) {
      for (const Transmission& packet : offered) observer_->OnQueued(Info(packet));
    }
    outbox_.Step(
        t, offered, [this, step](const Departure& departure) { Send(step, departure); },
        [this](const Transmission& packet) { Discard(packet, DropReason::kQueue); });
  }

  void Deliver(int receiver, TimeNs until, std::vector<Reception>* out) override {
    auto& queue = pending_[static_cast<std::size_t>(receiver)];
    if (queue.empty()) return;
    ripe_.clear();
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const Reception& r = queue[i].reception;
      if (r.arrival <= until) ripe_.push_back({r.arrival, r.source, i});
    }
    if (ripe_.size() > 1) std::sort(ripe_.begin(), ripe_.end());
    for (const Ripe& ripe : ripe_) {
      const Pending& pending = queue[ripe.index];
      const Reception& r = pending.reception;
      table_.Deliver(r.source, receiver, r.generation, r.transmit, r.arrival);
      if (observer_ != nullptr) Tell(pending, DropReason::kNone);
      payloads_.Release(pending.payload);
      out->push_back(r);
      out->back().payload = payloads_.at(pending.payload);
    }
    if (ripe_.size() == queue.size()) {
      queue.clear();
    } else {
      const auto ripe = [until](const Pending& p) { return p.reception.arrival <= until; };
      queue.erase(std::remove_if(queue.begin(), queue.end(), ripe), queue.end());
    }
  }

  LinkStatistics Link(int source, int destination, TimeNs now) const override {
    assert(source >= 0 && source < nodes_ && destination >= 0 && destination < nodes_);
    if (source == destination) return {};
    LinkStatistics s = table_.At(source, destination, now);
    if (!started_) return s;
    const std::size_t i = static_cast<std::size_t>(source);
    const std::size_t j = static_cast<std::size_t>(destination);
    s.distance_m = Norm(Vec3<double>{x_[j] - x_[i], y_[j] - y_[i], z_[j] - z_[i]});
    const LinkValues<double> link = formula_.At(s.distance_m, s.age_s);
    s.delay_s = formula_.DelayS(s.distance_m);
    const bool reaches = formula_.Reaches(s.distance_m);
    s.loss_probability = reaches ? link.loss : 1.0;
    // Before the first packet there is no freshness, although the age counts from the start.
    const bool informed = !formula_.ages() || s.delivered > 0;
    s.quality = reaches && informed ? link.quality : 0.0;
    return s;
  }

  const ChannelTotals& totals() const override { return table_.totals(); }

 private:
  struct Pending {
    Reception reception;
    TimeNs offered;  ///< Transmission::stamp
    int payload;     ///< handle in the pool
  };
  struct Ripe {
    TimeNs arrival;
    int source;
    std::size_t index;  ///< in order of sending
    bool operator<(const Ripe& o) const {
      if (arrival != o.arrival) return arrival < o.arrival;
      if (source != o.source) return source < o.source;
      return index < o.index;
    }
  };

  void Place(const std::vector<Vec3<double>>& p_W, const std::vector<Vec3<double>>& v_W) {
    double finite = 0.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(nodes_); ++i) {
      const Vec3<double>&p = p_W[i], &v = v_W[i];
      if (absent_ > 0 && present_[i] == 0) continue;
      finite += (p.x + p.y + p.z) * 0.0 + (v.x + v.y + v.z) * 0.0;
      x_[i] = p.x;
      y_[i] = p.y;
      z_[i] = p.z;
      vx_[i] = v.x;
      vy_[i] = v.y;
      vz_[i] = v.z;
    }
    if (!(finite == 0.0))
      throw std::invalid_argument("Channel::Step: the state of a node is not finite");
  }

  /// Receivers of a packet: [first, last) without the source.
  int FirstReceiver(const Transmission& packet) const {
    return packet.destination == kToAll ? 0 : packet.destination;
  }
  int LastReceiver(const Transmission& packet) const {
    return packet.destination == kToAll ? nodes_ : packet.destination + 1;
  }

  PacketInfo Info(const Transmission& packet) const {
    PacketInfo info;
    info.source = packet.source;
    info.destination = packet.destination;
    info.tag = packet.tag;
    info.bytes = packet.payload.size;
    info.offered = packet.stamp;
    info.generation = packet.generation;
    return info;
  }
  PacketInfo Info(const Departure& departure) const {
    PacketInfo info = Info(departure.packet);
    info.sequence = departure.sequence;
    info.transmit = info.transmit_end = departure.start;
    return info;
  }
  void Tell(const Pending& pending, DropReason reason) const {
    const Reception& r = pending.reception;
    PacketInfo info;
    info.source = r.source;
    info.destination = r.destination;
    info.tag = r.tag;
    info.sequence = r.sequence;
    info.bytes = payloads_.at(pending.payload).size;
    info.offered = pending.offered;
    info.generation = r.generation;
    info.transmit = info.transmit_end = r.transmit;
    PacketFate fate;
    fate.receiver = r.receiver;
    fate.reason = reason;
    fate.begin = fate.arrival = r.arrival;
    fate.distance_m = r.distance_m;
    fate.travel_time_s = r.travel_time_s;
    fate.loss_probability = r.loss_probability;
    observer_->OnFate(info, fate);
  }

  void Discard(const Transmission& packet, DropReason reason) {
    for (int j = FirstReceiver(packet); j < LastReceiver(packet); ++j) {
      if (j != packet.source) table_.Drop(packet.source, j, reason);
    }
    if (observer_ != nullptr) observer_->OnDiscarded(Info(packet), reason, now_);
  }

  /// A packet that left and will not arrive.
  void Lose(const Departure& departure, int receiver, DropReason reason) {
    table_.Drop(departure.packet.source, receiver, reason);
    if (observer_ == nullptr) return;
    const auto j = static_cast<std::size_t>(receiver);
    PacketFate fate;
    fate.receiver = receiver;
    fate.reason = reason;
    fate.begin = fate.arrival = Arrival(departure, receiver);
    fate.distance_m = distance_[j];
    fate.travel_time_s = delay_s_[j];
    fate.loss_probability = loss_[j];
    observer_->OnFate(Info(departure), fate);
  }
  TimeNs Arrival(const Departure& departure, int receiver) const {
    const double delay_ns = delay_s_[static_cast<std::size_t>(receiver)] * 1e9;
    // Delays are not negative. NOLINTNEXTLINE(bugprone-incorrect-roundings)
    return departure.start + static_cast<TimeNs>(delay_ns + 0.5);
  }

  void Send(std::uint32_t step, const Departure& departure) {
    const Transmission& packet = departure.packet;
    assert(packet.source >= 0 && packet.source < nodes_);
    assert(packet.payload.size > 0 && packet.payload.size <= max_payload());
    assert(present_[static_cast<std::size_t>(packet.source)] != 0);
    if (observer_ != nullptr) observer_->OnSent(Info(departure));
    Evaluate(packet.source, Seconds(departure.start - packet.generation));
    int payload = kNoPayload;
    for (int receiver = FirstReceiver(packet); receiver < LastReceiver(packet); ++receiver) {
      if (receiver == packet.source) continue;
      const auto j = static_cast<std::size_t>(receiver);
      if (present_[j] == 0) {
        Lose(departure, receiver, DropReason::kLeft);
        continue;
      }
      if (!formula_.Reaches(distance_[j])) {
        Lose(departure, receiver, DropReason::kRange);
        continue;
      }
      if (loss_[j] > 0.0) {
        Random random(seed_, Stream::kChannel, episode_, step,
                      static_cast<std::uint32_t>(packet.source * nodes_ + receiver));
        if (random.Uniform() < loss_[j]) {
          Lose(departure, receiver, DropReason::kLoss);
          continue;
        }
      }
      if (payload == kNoPayload) payload = payloads_.Store(packet.payload);
      payloads_.Hold(payload);
      Pending& pending = pending_[j].emplace_back();
      pending.payload = payload;
      Reception& r = pending.reception;
      r.source = packet.source;
      r.receiver = receiver;
      r.destination = packet.destination;
      r.sequence = departure.sequence;
      r.generation = packet.generation;
      r.transmit = departure.start;
      r.arrival = Arrival(departure, receiver);
      r.distance_m = distance_[j];
      r.travel_time_s = delay_s_[j];
      r.loss_probability = loss_[j];
      r.link_quality = quality_[j];
      r.doppler_mps = closing_[j];
      r.tag = packet.tag;
      pending.offered = packet.stamp;
    }
  }

  /// Links from `source` to all nodes into the scratch arrays, for a payload of this age at
  /// transmission; quality is that at arrival.
  void Evaluate(int source, double age_s) {
    const auto s = static_cast<std::size_t>(source);
    const Vec3<Pack> origin = Broadcast({x_[s], y_[s], z_[s]});
    const Vec3<Pack> own = Broadcast({vx_[s], vy_[s], vz_[s]});
    const Pack zero(0.0);
    for (std::size_t j = 0; j < static_cast<std::size_t>(padded_);
         j += static_cast<std::size_t>(kLanes)) {
      const Vec3<Pack> p{Pack::load_unaligned(&x_[j]), Pack::load_unaligned(&y_[j]),
                         Pack::load_unaligned(&z_[j])};
      const Vec3<Pack> v{Pack::load_unaligned(&vx_[j]), Pack::load_unaligned(&vy_[j]),
                         Pack::load_unaligned(&vz_[j])};
      const Vec3<Pack> r = p - origin;
      const Pack d = Norm(r);
      const Pack delay_s = formula_.DelayS(d);
      const LinkValues<Pack> link = formula_.At(d, Pack(age_s) + delay_s);
      const Pack closing = Select(d > zero, Dot(own - v, r) / d, zero);
      d.store_unaligned(&distance_[j]);
      link.loss.store_unaligned(&loss_[j]);
      link.quality.store_unaligned(&quality_[j]);
      delay_s.store_unaligned(&delay_s_[j]);
      closing.store_unaligned(&closing_[j]);
    }
  }

  static constexpr int kNoPayload = -1;

  const int nodes_, padded_;
  const Formula formula_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
  bool started_ = false;
  TimeNs now_ = 0;
  PacketObserver* observer_ = nullptr;
  Outbox outbox_;
  PayloadPool payloads_;
  LinkTable table_;
  std::vector<double> x_, y_, z_, vx_, vy_, vz_;             ///< padded to whole packs
  std::vector<double> distance_, loss_, quality_, delay_s_;  ///< scratch of one sender
  std::vector<double> closing_;
  std::vector<char> present_;                  ///< [nodes]
  int absent_ = 0;                             ///< how many are not
  std::vector<std::vector<Pending>> pending_;  ///< per receiver, as sent
  std::vector<Ripe> ripe_;                     ///< scratch of Deliver
};

}  // namespace stg::acoustics

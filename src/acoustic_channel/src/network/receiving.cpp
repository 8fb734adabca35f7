#include <algorithm>
#include <limits>

#include "auv_common/numbers/random.hpp"
#include "network_impl.hpp"

/// The receiving side: which packets are acquired, the effect of interference, and the reasons of
/// losses.
namespace stg::acoustics {

void Network::Impl::Begin(int arrival, TimeNs t) {
  Arrival& a = arrivals_[arrival];
  Node& n = At(a.receiver);
  const Packet& p = packets_[a.packet];
  if (n.locked != kNone) Integrate(&n, t);
  n.active.push_back(arrival);
  events_.Push(a.end, EventKind::kArrivalEnd, p.info.source, a.receiver, arrival);
  const ModemProfile& sender = SenderOf(a);
  if (!n.present) {
    if (a.open) Drop(&a, DropReason::kLeft, 0.0, 0.0, 0.0);
  } else if (n.sending != kNone) {
    if (a.open) Drop(&a, DropReason::kHalfDuplex, 0.0, 0.0, 0.0);
  } else if (!Understands(n, sender)) {
    if (a.open) Drop(&a, DropReason::kNotAcquired, 0.0, 0.0, 0.0);
  } else if (n.locked != kNone) {
    const double disturbance = n.noise + Interference(n, arrival);
    if (a.open) Drop(&a, DropReason::kCollision, Db(n.noise), Db(a.power / disturbance), 0.0);
  } else {
    a.candidate = true;
    events_.Push(t, EventKind::kAcquire, p.info.source, a.receiver, arrival);
  }
}

bool Network::Impl::Understands(const Node& n, const ModemProfile& sender) const {
  return sender.waveform == n.profile.waveform ||
         std::find(n.waveforms.begin(), n.waveforms.end(), sender.waveform) != n.waveforms.end();
}

void Network::Impl::Acquire(int node, TimeNs t) {
  // Of packets that begin together, the strongest is tried first. The others then find the receiver
  // locked.
  for (;;) {
    Node& n = At(node);
    int best = kNone;
    for (const int arrival : n.active) {
      const Arrival& a = arrivals_[arrival];
      if (a.candidate && (best == kNone || a.power > arrivals_[best].power)) best = arrival;
    }
    if (best == kNone) return;
    arrivals_[best].candidate = false;
    LockOrDrop(node, best, t);
  }
}

void Network::Impl::SenseNoise(int node, TimeNs t) {
  Node& n = At(node);
  const NoiseSpan span = medium_->Noise(node, t, Norm(n.motion.v_W), n.profile);
  n.noise = FromDb(span.level_db);
  n.quiet_noise = FromDb(span.quiet_level_db);
  if (n.locked != kNone && span.until < arrivals_[n.locked].end) {
    events_.Push(span.until, EventKind::kNoise, 0, node, n.locked);
  }
}

double Network::Impl::Interference(const Node& n, int but) const {
  const ModemProfile* wanted = but == kNone ? nullptr : &SenderOf(arrivals_[but]);
  double others = 0.0, alike = 0.0;
  for (const int arrival : n.active) {
    if (arrival == but) continue;
    const Arrival& a = arrivals_[arrival];
    (wanted != nullptr && SenderOf(a).waveform == wanted->waveform ? alike : others) += a.power;
  }
  return alike > 0.0 ? others + alike * FromDb(wanted->spreading_db) : others;
}

bool Network::Impl::HearsCarrier(int node, TimeNs t) {
  Node& n = At(node);
  if (n.active.empty()) return false;
  if (n.locked != kNone) return true;
  SenseNoise(node, t);
  return Interference(n, kNone) >= n.noise * FromDb(n.profile.acquisition_db);
}

void Network::Impl::LockOrDrop(int node, int arrival, TimeNs t) {
  Node& n = At(node);
  Arrival& a = arrivals_[arrival];
  if (n.locked == kNone) SenseNoise(node, t);
  const double noise_db = Db(n.noise);
  const double interference = Interference(n, arrival);
  const double sinr_db = Db(a.power / (n.noise + interference));
  const double needed_db = n.profile.acquisition_db;
  if (n.locked != kNone) {
    if (a.open) Drop(&a, DropReason::kCollision, noise_db, sinr_db, 0.0);
    return;
  }
  if (sinr_db >= needed_db) {
    n.locked = arrival;
    n.lock_begin = a.piece_begin = t;
    SenseNoise(node, t);  // again, so that changes of the noise are tracked
    if (observer_ != nullptr) observer_->OnAcquired(packets_[a.packet].info, node, a.begin);
    return;
  }
  if (!a.open) return;
  const double quiet_db = Db(n.quiet_noise);
  const DropReason reason =
      interference > 0.0 && a.hearing.level_db - noise_db >= needed_db ? DropReason::kCollision
      : a.hearing.level_db - quiet_db >= needed_db                     ? DropReason::kBurst
      : a.hearing.steady_level_db - quiet_db >= needed_db              ? DropReason::kFading
      : a.hearing.clear_level_db - quiet_db >= needed_db               ? DropReason::kShadow
                                                                       : DropReason::kNotAcquired;
  Drop(&a, reason, noise_db, sinr_db, 0.0);
}

void Network::Impl::Integrate(Node* n, TimeNs t) {
  Arrival& a = arrivals_[n->locked];
  if (t <= a.piece_begin) return;
  const double share =
      static_cast<double>(t - a.piece_begin) / static_cast<double>(a.end - a.begin);
  const double interference = Interference(*n, n->locked);
  const double sinr_db = Db(a.power / (n->noise + interference));
  const Packet& p = packets_[a.packet];
  // The sender chooses the rate, so the error curve is from its modem.
  const ModemProfile& sender = SenderOf(a);
  a.log_success += sender.errors.LogSuccess(sinr_db - sender.implementation_db, p.bits * share);
  a.noise += n->noise * share;
  a.interference += interference * share;
  a.piece_begin = t;
}

void Network::Impl::ChangeNoise(int node, int arrival, TimeNs t) {
  Node& n = At(node);
  if (n.locked == kNone || n.locked != arrival) return;
  Integrate(&n, t);
  SenseNoise(node, t);
}

void Network::Impl::Unlock(Node* n, TimeNs t) {
  if (n->locked == kNone) return;
  n->received_ns += t - n->lock_begin;
  n->locked = kNone;
}

void Network::Impl::End(int arrival, TimeNs t) {
  Arrival& a = arrivals_[arrival];
  Node& n = At(a.receiver);
  if (n.locked != kNone) Integrate(&n, t);
  n.active.erase(std::find(n.active.begin(), n.active.end(), arrival));
  if (n.locked == arrival) {
    Unlock(&n, t);
    Finish(arrival, t);
  }
  const int packet = a.packet;
  arrivals_.Remove(arrival);
  ReleasePacket(packet);
}

void Network::Impl::Finish(int arrival, TimeNs t) {
  const Arrival a = arrivals_[arrival];
  if (!a.open && observer_ == nullptr) return;
  const Packet& p = packets_[a.packet];
  const ModemProfile& profile = SenderOf(a);
  Random random(seed_, Stream::kReception, episode_, p.draw_sequence,
                static_cast<std::uint32_t>(p.info.source * count_ + a.receiver));
  const double luck = random.Uniform();
  const double loss = 0.0 - std::expm1(a.log_success);
  const double noise_db = Db(a.noise);
  const double sinr_db = Db(a.power / (a.noise + a.interference));
  if (luck < 1.0 - loss) {
    if (!a.open) {
      // Only overheard by this node.
    } else if (p.info.kind == PacketKind::kPing) {
      Tell(p, FateOf(a));
      Answer(a, t);
    } else if (p.info.kind == PacketKind::kReply) {
      Tell(p, FateOf(a));
      TakeReply(a, t);
    } else if (p.info.kind == PacketKind::kData) {
      Deliver(p, a, loss, sinr_db);
    } else {
      Tell(p, FateOf(a));
    }
    EndLock(a, FateOf(a), true, t);
    return;
  }
  // With the same draw, which better condition would have saved the packet?
  const auto survives = [&](double snr_db) {
    return luck < std::exp(profile.errors.LogSuccess(snr_db - profile.implementation_db, p.bits));
  };
  const double quiet_db = Db(At(a.receiver).quiet_noise);
  const DropReason reason = a.interference > 0.0 && survives(Db(a.power / a.noise))
                                ? DropReason::kCollision
                            : survives(a.hearing.level_db - quiet_db)        ? DropReason::kBurst
                            : survives(a.hearing.steady_level_db - quiet_db) ? DropReason::kFading
                            : survives(a.hearing.clear_level_db - quiet_db)  ? DropReason::kShadow
                                                                             : DropReason::kLoss;
  if (a.open) Drop(&arrivals_[arrival], reason, noise_db, sinr_db, loss);
  PacketFate fate = FateOf(a);
  fate.reason = reason;
  EndLock(a, fate, false, t);
}

void Network::Impl::EndLock(const Arrival& a, const PacketFate& fate, bool read, TimeNs t) {
  if (observer_ == nullptr) return;
  const Packet& p = packets_[a.packet];
  HeardEnd end;
  end.fate = fate;
  end.closing_mps = a.closing_mps;
  if (read) end.payload = payloads_.at(p.payload);
  observer_->OnReceptionEnd(p.info, end, t);
}

void Network::Impl::BreakLock(const Arrival& a, DropReason reason, TimeNs t) {
  PacketFate fate = FateOf(a);
  fate.reason = reason;
  EndLock(a, fate, false, t);
}

PacketFate Network::Impl::FateOf(const Arrival& a) const {
  PacketFate fate;
  fate.receiver = a.receiver;
  fate.begin = a.begin;
  fate.arrival = a.end;
  fate.distance_m = a.hearing.distance_m;
  fate.travel_time_s = a.hearing.travel_time_s;
  if (SenderOf(a).ideal) return fate;
  fate.received_level_db = a.hearing.level_db;
  if (a.noise > 0.0) {
    fate.noise_level_db = Db(a.noise);
    fate.sinr_db = Db(a.power / (a.noise + a.interference));
    fate.loss_probability = 0.0 - std::expm1(a.log_success);
  }
  return fate;
}

void Network::Impl::Tell(const Packet& packet, const PacketFate& fate) {
  if (observer_ != nullptr) observer_->OnFate(packet.info, fate);
}

void Network::Impl::Drop(Arrival* a, DropReason reason, double noise_db, double sinr_db,
                         double loss) {
  const Packet& p = packets_[a->packet];
  a->open = false;
  if (p.info.kind == PacketKind::kData) table_.Drop(p.info.source, a->receiver, reason);
  if (observer_ == nullptr) return;
  PacketFate fate = FateOf(*a);
  fate.reason = reason;
  if (noise_db != 0.0) {
    fate.noise_level_db = noise_db;
    fate.sinr_db = sinr_db;
  }
  fate.loss_probability = loss;
  Tell(p, fate);
}

void Network::Impl::AddTimingError(const Packet& p, int receiver, double* travel_time_s) const {
  if (config_.timing_std_s <= 0.0 && config_.late_probability <= 0.0) return;
  Random random(seed_, Stream::kTiming, episode_, p.draw_sequence,
                static_cast<std::uint32_t>(p.info.source * count_ + receiver));
  *travel_time_s += config_.timing_std_s * random.Normal();
  const bool late = random.Uniform() < config_.late_probability;
  const double by_s = config_.late_max_s * random.Uniform();
  if (late) *travel_time_s += by_s;
}

void Network::Impl::Deliver(const Packet& p, const Arrival& a, double loss, double sinr_db) {
  const Node& source = At(p.info.source);
  Node& n = At(a.receiver);
  Delivered& d = n.delivered.emplace_back();
  d.payload = p.payload;
  payloads_.Hold(p.payload);
  Reception& r = d.reception;
  r.source = p.info.source;
  r.receiver = a.receiver;
  r.destination = p.info.destination;
  r.sequence = p.info.sequence;
  r.generation = p.info.generation;
  r.transmit = p.info.transmit;
  r.arrival = a.end;
  r.distance_m = a.hearing.distance_m;
  r.travel_time_s =
      a.hearing.travel_time_s + ClockError(n, a.begin) - ClockError(source, p.info.transmit);
  AddTimingError(p, a.receiver, &r.travel_time_s);
  r.loss_probability = loss;
  const double age_s = Seconds(a.end - p.info.generation);
  r.link_quality = (1.0 - loss) * std::exp(-age_s / config_.freshness_s);
  r.doppler_mps = a.closing_mps;
  r.tag = p.info.tag;
  r.header = p.info.header;
  const PacketFate fate = FateOf(a);
  r.received_level_db = fate.received_level_db;
  r.noise_level_db = fate.noise_level_db;
  r.sinr_db = sinr_db;
  table_.Deliver(r.source, r.receiver, r.generation, r.transmit, r.arrival);
  Tell(p, fate);
}

}  // namespace stg::acoustics

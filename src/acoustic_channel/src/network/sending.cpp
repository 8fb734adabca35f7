#include <algorithm>

#include "network_impl.hpp"

/// The sending side: queues, medium access, transmissions, and pings.
namespace stg::acoustics {
namespace {

/// A sound that is farther below the noise than this is neither received nor interferes [dB].
constexpr double kInaudibleDb = -20.0;
/// Pings and replies have their own counter, because sequences are for packets with data.
constexpr std::uint32_t kControl = 0x80000000;

/// Share of the sender's power in the receiver's band.
double Overlap(const ModemProfile& sender, const ModemProfile& receiver) {
  const double low = std::max(sender.centre_khz - 0.5 * sender.bandwidth_khz,
                              receiver.centre_khz - 0.5 * receiver.bandwidth_khz);
  const double high = std::min(sender.centre_khz + 0.5 * sender.bandwidth_khz,
                               receiver.centre_khz + 0.5 * receiver.bandwidth_khz);
  return std::max(0.0, high - low) / sender.bandwidth_khz;
}

}  // namespace

int Network::Impl::MakePacket(const Transmission& offer, PacketKind kind) {
  Packet p;
  p.info.source = offer.source;
  p.info.destination = offer.destination;
  p.info.kind = kind;
  p.info.tag = offer.tag;
  p.info.bytes = offer.payload.size;
  p.info.offered = offer.stamp;
  p.info.generation = offer.generation;
  p.payload = payloads_.Store(offer.payload);
  payloads_.Hold(p.payload);
  p.holders = 1;
  const ModemProfile& profile = offer.mode != nullptr ? *offer.mode : At(offer.source).profile;
  const std::size_t air_bytes = offer.air_bytes > 0 ? offer.air_bytes : p.info.bytes;
  p.info.mode = &profile;
  p.info.header = offer.header;
  p.airtime = profile.airtime(air_bytes);
  p.level_db = offer.level_db;
  p.bits = 8.0 * static_cast<double>(profile.frames(air_bytes) * profile.frame_bytes);
  return packets_.Add(p);
}

void Network::Impl::ReleasePacket(int packet) {
  Packet& p = packets_[packet];
  assert(p.holders > 0);
  if (--p.holders > 0) return;
  payloads_.Release(p.payload);
  packets_.Remove(packet);
}

void Network::Impl::Queue(int packet, TimeNs t) {
  const Packet& p = packets_[packet];
  const int node = p.info.source;
  Node& n = At(node);
  if (observer_ != nullptr) observer_->OnQueued(p.info);
  if (!n.present) {
    Discard(packet, DropReason::kLeft, t);
    return;
  }
  if (p.info.kind == PacketKind::kPing) {
    if (n.ping.open) {
      n.ping.result.replaced = true;
      EndPing(node, t, false);
    }
    if (n.request != kNone) Discard(n.request, DropReason::kQueue, t);
    n.request = packet;
    StartPing(packet, t);
  } else if (config_.queue == QueuePolicy::kFifo) {
    if (static_cast<int>(n.queue.size()) == config_.queue_length) {
      Discard(packet, DropReason::kQueue, t);
      return;
    }
    n.queue.push_back(packet);
  } else {
    if (!n.queue.empty()) Discard(n.queue.back(), DropReason::kQueue, t);
    n.queue.assign(1, packet);
  }
  Attempt(node, t);
}

bool Network::Impl::Cancel(int node, std::uint32_t tag, TimeNs t) {
  std::vector<int>& queue = At(node).queue;
  const auto found = std::find_if(queue.begin(), queue.end(),
                                  [&](int packet) { return packets_[packet].info.tag == tag; });
  if (found == queue.end()) return false;
  const int packet = *found;
  queue.erase(found);
  Discard(packet, DropReason::kQueue, t);
  return true;
}

void Network::Impl::Discard(int packet, DropReason reason, TimeNs t) {
  const PacketInfo& info = packets_[packet].info;
  if (info.kind == PacketKind::kData && info.destination != kToNone) {
    const bool all = info.destination == kToAll;
    for (int j = all ? 0 : info.destination; j < (all ? talkers_ : info.destination + 1); ++j) {
      if (j != info.source) table_.Drop(info.source, j, reason);
    }
  }
  if (observer_ != nullptr) observer_->OnDiscarded(info, reason, t);
  ReleasePacket(packet);
}

void Network::Impl::Attempt(int node, TimeNs t) {
  Node& n = At(node);
  if (n.attempts || n.sending != kNone || !n.present) return;
  if (n.queue.empty() && n.request == kNone) return;
  const acoustics::Attempt attempt{n.sequence, n.tries, n.last_end};
  const TimeNs start = access_->Next(node, std::max(t, n.ready), attempt);
  if (start == kNever) return;
  n.attempts = true;
  events_.Push(start, EventKind::kSend, node, 0, kNone);
}

void Network::Impl::TrySend(int node, TimeNs t) {
  Node& n = At(node);
  n.attempts = false;
  if (n.sending != kNone || !n.present) return;
  if (n.queue.empty() && n.request == kNone) return;
  if (t < n.ready) {
    Attempt(node, t);
    return;
  }
  if (access_->listens() && HearsCarrier(node, t)) {
    ++n.tries;
    Attempt(node, t);
    return;
  }
  n.tries = 0;
  int packet = n.request;
  if (packet != kNone) {
    n.request = kNone;
  } else {
    packet = n.queue.front();
    n.queue.erase(n.queue.begin());
  }
  Send(node, packet, t);
}

void Network::Impl::Send(int node, int packet, TimeNs t) {
  Node& n = At(node);
  Packet& p = packets_[packet];
  const bool data = p.info.kind == PacketKind::kData;
  p.info.sequence = data ? n.sequence++ : n.control_sequence++;
  p.draw_sequence = data ? p.info.sequence : kControl | p.info.sequence;
  p.info.transmit = t;
  p.info.transmit_end = t + p.airtime;
  if (p.info.kind == PacketKind::kPing) n.ping.transmit = t;
  if (n.locked != kNone) {
    Arrival& lost = arrivals_[n.locked];
    Unlock(&n, t);
    if (lost.open) Drop(&lost, DropReason::kHalfDuplex, 0.0, 0.0, 0.0);
    BreakLock(lost, DropReason::kHalfDuplex, t);
  }
  n.sending = packet;
  n.send_begin = t;
  n.send_end = p.info.transmit_end;
  n.ready = n.send_end + n.profile.turnaround();
  if (observer_ != nullptr) observer_->OnSent(p.info);
  events_.Push(n.send_end, EventKind::kSendEnd, node, 0, packet);
  const NodeMotion motion = Motion(n, t);
  for (int j = 0; j < count_; ++j) {
    if (j != node) Propagate(packet, j, t, motion);
  }
}

void Network::Impl::EndSend(int node, TimeNs t) {
  Node& n = At(node);
  const int packet = n.sending;
  n.sending = kNone;
  n.sent_ns += t - n.send_begin;
  n.last_end = t;
  if (observer_ != nullptr) observer_->OnSendEnd(packets_[packet].info);
  ReleasePacket(packet);
  Attempt(node, t);
}

void Network::Impl::Propagate(int packet, int receiver, TimeNs t, const NodeMotion& source) {
  Packet& p = packets_[packet];
  const ModemProfile& sender = *p.info.mode;
  Node& r = At(receiver);
  const NodeMotion target = Motion(r, t);
  Arrival a;
  a.packet = packet;
  a.receiver = receiver;
  a.open = IsFor(p, receiver);
  const PacketKey key{p.info.source, receiver, p.draw_sequence, t};
  a.hearing = medium_->Hear(key, source, target, sender);
  if (p.level_db != 0.0) {
    a.hearing.level_db += p.level_db;
    a.hearing.steady_level_db += p.level_db;
    a.hearing.clear_level_db += p.level_db;
  }
  const Vec3<double> way = target.p_W - source.p_W;
  const double distance = a.hearing.distance_m;
  a.closing_mps = distance > 0.0 ? Dot(source.v_W - target.v_W, way) / distance : 0.0;
  a.begin = t;
  a.end = p.info.transmit_end;
  if (!r.present) {
    if (a.open) Drop(&a, DropReason::kLeft, 0.0, 0.0, 0.0);
    return;
  }
  const bool understood = Understands(r, sender);
  if (sender.ideal) {
    a.hearing.travel_time_s = 0.0;
    if (!a.open) return;
    if (understood) {
      Deliver(p, a, 0.0, 0.0);
    } else {
      Drop(&a, DropReason::kNotAcquired, 0.0, 0.0, 0.0);
    }
    return;
  }
  const TimeNs delay = std::llround(a.hearing.travel_time_s * 1e9);
  a.begin += delay;
  a.end += delay;
  const double overlap = r.profile.ideal ? 0.0 : Overlap(sender, r.profile);
  if (overlap <= 0.0) {
    if (a.open) Drop(&a, DropReason::kNotAcquired, 0.0, 0.0, 0.0);
    return;
  }
  const NoiseSpan noise = medium_->Noise(receiver, a.begin, Norm(target.v_W), r.profile);
  const double audible_db = noise.quiet_level_db + kInaudibleDb;
  if (a.hearing.level_db < audible_db) {
    if (!a.open) return;
    const DropReason reason = a.hearing.steady_level_db >= audible_db  ? DropReason::kFading
                              : a.hearing.clear_level_db >= audible_db ? DropReason::kShadow
                                                                       : DropReason::kRange;
    Drop(&a, reason, noise.level_db, a.hearing.level_db - noise.level_db, 0.0);
    return;
  }
  a.power = FromDb(a.hearing.level_db) * overlap;
  ++p.holders;
  const int arrival = arrivals_.Add(a);
  events_.Push(a.begin, EventKind::kArrivalBegin, p.info.source, receiver, arrival);
}

void Network::Impl::StartPing(int packet, TimeNs t) {
  Packet& p = packets_[packet];
  Node& n = At(p.info.source);
  Ping ping;
  ping.number = (n.ping.number + 1) & 0x7fffffff;
  ping.open = true;
  ping.result.source = p.info.source;
  ping.result.destination = p.info.destination;
  ping.result.tag = p.info.tag;
  ping.result.asked = t;
  n.ping = ping;
  p.ping = ping.number;
  events_.Push(std::max(t, p.deadline), EventKind::kTimeout, p.info.source, 0,
               static_cast<int>(ping.number));
}

void Network::Impl::EndPing(int node, TimeNs t, bool answered) {
  Ping& ping = At(node).ping;
  ping.open = false;
  ping.result.answered = answered;
  ping.result.ended = t;
  if (observer_ != nullptr) observer_->OnPing(ping.result);
}

void Network::Impl::Answer(const Arrival& request, TimeNs t) {
  const Packet& asked = packets_[request.packet];
  const Node& n = At(request.receiver);
  Transmission reply;
  reply.source = request.receiver;
  reply.destination = asked.info.source;
  // The modem measures its turnaround with its own clock.
  reply.stamp = reply.generation =
      t + std::llround(n.profile.turnaround_s / (1.0 + n.clock_rate) * 1e9);
  reply.tag = asked.info.tag;
  const std::uint8_t nothing = 0;
  reply.payload = {&nothing, 1};
  const std::uint32_t number = asked.ping;
  Ping& ping = At(asked.info.source).ping;
  if (ping.number == number) AddTimingError(asked, request.receiver, &ping.request_error_s);
  const int packet = MakePacket(reply, PacketKind::kReply);
  packets_[packet].ping = number;
  events_.Push(reply.stamp, EventKind::kReply, reply.source, 0, packet);
}

void Network::Impl::Reply(int node, int packet, TimeNs t) {
  Node& n = At(node);
  if (observer_ != nullptr) observer_->OnQueued(packets_[packet].info);
  if (!n.present) {
    Discard(packet, DropReason::kLeft, t);
  } else if (n.sending != kNone) {
    Discard(packet, DropReason::kQueue, t);
  } else {
    Send(node, packet, t);
  }
}

void Network::Impl::TakeReply(const Arrival& reply, TimeNs t) {
  const Packet& p = packets_[reply.packet];
  Node& n = At(reply.receiver);
  Ping& ping = n.ping;
  if (!ping.open || ping.number != p.ping) return;
  const ModemProfile& other = At(p.info.source).profile;
  const double watched_s = Seconds(t - ping.transmit) * (1.0 + n.clock_rate);
  ping.result.round_trip_s = watched_s - n.profile.airtime_s(1) - other.airtime_s(1) -
                             other.turnaround_s + ping.request_error_s;
  AddTimingError(p, reply.receiver, &ping.result.round_trip_s);
  ping.result.range_m = 0.5 * ping.result.round_trip_s * medium_->SoundSpeed(Motion(n, t).p_W);
  ping.result.true_range_m = reply.hearing.distance_m;
  ping.result.middle = ping.transmit + (p.info.transmit - ping.transmit) / 2;
  EndPing(reply.receiver, t, true);
}

}  // namespace stg::acoustics

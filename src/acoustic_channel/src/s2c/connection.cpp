#include "acoustic_channel/s2c/connection.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "acoustic_channel/access/medium_access.hpp"

namespace stg::acoustics::s2c {
namespace {

constexpr TimeNs kBackoffTime = 2'000'000'000;
/// Two modems that call each other at the same time must not do so forever.
constexpr TimeNs kApart = 125'000'000;
constexpr int kSteps = 8;

}  // namespace

void Connection::Reset() {
  Forget();
  buffer_.clear();
  count_ = 0;
  state_ = State::kOffline;
}

void Connection::Forget() {
  state_ = State::kOffline;
  peer_ = 0;
  step_ = Step::kNothing;
  number_ = heard_ = 0;
  propagation_us_ = 0;
}

std::size_t Connection::free_bytes() const {
  std::size_t used = 0;
  for (const Chunk& chunk : buffer_) used += chunk.data.size();
  return settings_.pool_bytes - std::min(settings_.pool_bytes, used);
}

std::string Connection::Add(int destination, int pid, const std::string& data, TimeNs t) {
  return AddChunk({destination, pid, false, data}, t);
}

std::string Connection::AddRaw(int destination, const std::string& data, TimeNs t) {
  // The first chunk cannot be extended, because it may be on its way.
  const bool joins = buffer_.size() > 1 && buffer_.back().raw &&
                     buffer_.back().destination == destination &&
                     buffer_.back().data.size() + data.size() <= kLongestBurst;
  if (!joins) return AddChunk({destination, 0, true, data}, t);
  if (data.size() > free_bytes()) return "ERROR BUFFER FULL";
  buffer_.back().data += data;
  return "OK";
}

std::string Connection::AddChunk(Chunk chunk, TimeNs t) {
  if (!buffer_.empty() && buffer_.back().destination != chunk.destination) {
    return "ERROR BUFFER IS NOT EMPTY";
  }
  if (chunk.data.size() > free_bytes()) return "ERROR BUFFER FULL";
  if (state_ == State::kOnline && peer_ != chunk.destination) Close(false);
  buffer_.push_back(std::move(chunk));
  Continue(t);
  return "OK";
}

std::string Connection::Dial(int destination, TimeNs t) {
  if (state_ == State::kOnline) return peer_ == destination ? "OK" : "ERROR OUT OF CONTEXT";
  if (state_ != State::kOffline || !buffer_.empty()) return "ERROR OUT OF CONTEXT";
  peer_ = destination;
  state_ = State::kEstablish;
  Begin(MessageType::kConnect, t);
  return "INITIATION ESTABLISH";
}

void Connection::Close(bool tell_peer) {
  if (state_ == State::kOffline || state_ == State::kBackoff) return;
  const int peer = peer_;
  const bool online = state_ == State::kOnline;
  Clear();
  Forget();
  if (!tell_peer || !online) return;
  peer_ = peer;
  type_ = MessageType::kClose;
  step_ = Step::kReady;
}

void Connection::Clear() {
  std::size_t dropped = 0;
  for (const Chunk& chunk : buffer_) dropped += chunk.data.size();
  buffer_.clear();
  if (dropped > 0) tell_("DROPCNT," + std::to_string(dropped));
  if (type_ == MessageType::kBurst) step_ = Step::kNothing;
}

void Connection::Begin(MessageType type, TimeNs t) {
  type_ = type;
  step_ = Step::kReady;
  tries_left_ = settings_.repeats;
  if (type == MessageType::kBurst) number_ = number_ % 255 + 1;
  active_ = t;
}

/// Starts the next action, if there is one.
void Connection::Continue(TimeNs t) {
  if (step_ != Step::kNothing || buffer_.empty()) return;
  if (state_ == State::kOnline) Begin(MessageType::kBurst, t);
  if (state_ != State::kOffline) return;
  peer_ = buffer_.front().destination;
  state_ = State::kEstablish;
  Begin(MessageType::kConnect, t);
}

std::optional<Connection::Outgoing> Connection::Next(TimeNs t) {
  Continue(t);
  if (step_ != Step::kReady) return {};
  step_ = Step::kLeaving;
  Outgoing out;
  out.header.type = type_;
  out.header.source = settings_.address;
  out.header.destination = peer_;
  out.payload.assign(1, '\0');
  if (type_ != MessageType::kBurst) return out;
  const Chunk& chunk = buffer_.front();
  out.header.pid = chunk.pid;
  out.header.raw = chunk.raw;
  out.header.number = number_;
  out.header.propagation_us = propagation_us_;
  out.payload = chunk.data;
  return out;
}

void Connection::OnSendEnd(TimeNs begin, TimeNs end) {
  if (step_ != Step::kLeaving) return;
  began_ = begin;
  ended_ = end;
  active_ = end;
  if (type_ == MessageType::kClose) {
    step_ = Step::kNothing;
    if (state_ == State::kOffline) peer_ = 0;
    return;
  }
  step_ = Step::kAwaiting;
  deadline_ = end + settings_.patience + kApart * (settings_.address % kSteps);
}

void Connection::GoOnline(int peer, TimeNs t) {
  state_ = State::kOnline;
  peer_ = peer;
  active_ = t;
  step_ = Step::kNothing;
  number_ = heard_ = 0;
  const std::string rate = std::to_string(std::lround(kBurstBitrate));
  tell_("RADDR," + std::to_string(peer));
  tell_("BITRATE,local," + rate);
  tell_("BITRATE,remote," + rate);
  Continue(t);
}

bool Connection::TakeConnect(int source, TimeNs t) {
  if (state_ == State::kBackoff) return false;
  if (state_ != State::kOffline && peer_ != source) return false;
  // The peer calls again because it did not receive the answer. The data for it is sent again.
  GoOnline(source, t);
  return true;
}

bool Connection::TakeAccept(int source, TimeNs t) {
  if (state_ != State::kEstablish || peer_ != source) return false;
  if (step_ != Step::kAwaiting || type_ != MessageType::kConnect) return false;
  GoOnline(source, t);
  return true;
}

bool Connection::TakeBurst(const PacketHeader& header, TimeNs t, bool* fresh) {
  if (state_ != State::kOnline || header.source != peer_) return false;
  active_ = t;
  *fresh = header.number != heard_;
  heard_ = header.number;
  if (propagation_us_ == 0) propagation_us_ = header.propagation_us;
  return true;
}

void Connection::TakeBurstAck(const PacketHeader& header, TimeNs t) {
  const bool mine = state_ == State::kOnline && header.source == peer_ &&
                    step_ == Step::kAwaiting && type_ == MessageType::kBurst &&
                    header.number == number_;
  if (!mine || buffer_.empty()) return;
  buffer_.pop_front();
  step_ = Step::kNothing;
  active_ = t;
  tell_("DELIVERED," + std::to_string(++count_) + "," + std::to_string(peer_));
  Continue(t);
}

void Connection::TakeClose(int source) {
  if (state_ != State::kOnline || peer_ != source) return;
  Clear();
  Forget();
}

void Connection::Fail(TimeNs t) {
  for (const Chunk& chunk : buffer_) {
    tell_("FAILED," + std::to_string(++count_) + "," + std::to_string(chunk.destination));
  }
  Clear();
  Forget();
  state_ = State::kBackoff;
  backoff_ = t + kBackoffTime;
}

TimeNs Connection::next() const {
  if (state_ == State::kBackoff) return backoff_;
  if (step_ == Step::kAwaiting) return deadline_;
  const bool idle = state_ == State::kOnline && step_ == Step::kNothing && settings_.idle > 0;
  return idle ? active_ + settings_.idle : kNever;
}

void Connection::Tick(TimeNs t) {
  if (t < next()) return;
  if (state_ == State::kBackoff) {
    Forget();
    Continue(t);
  } else if (step_ != Step::kAwaiting) {
    Close(true);
  } else if (tries_left_ > 0) {
    --tries_left_;
    step_ = Step::kReady;
  } else {
    Fail(t);
  }
}

}  // namespace stg::acoustics::s2c

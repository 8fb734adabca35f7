#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "auv_common/numbers/attitude.hpp"
#include "measurement_fields.hpp"
#include "stg_agent/packet/measurement_packet.hpp"

/// The items of a packet about own ranges, bearings and fixes, for agents that locate each other.
namespace stg::agent {

TimeNs MeasurementPacket::SentAge(const NeighbourState& s, TimeNs stamp, Writer* w) const {
  const TimeNs steps = (s.generation - stamp + age_step_ / 2) / age_step_;
  constexpr TimeNs kMost = (1 << kSentAgeBits) - 1;
  w->saturated |= steps > kMost;
  return std::min(steps, kMost);
}

void MeasurementPacket::WriteSentBearing(const NeighbourState& s, Writer* w) const {
  const SentBearing& sent = s.bearing;
  if (sent.source < 0 || sent.source >= members_ || sent.stamp > s.generation ||
      !std::isfinite(sent.azimuth_rad)) {
    throw std::invalid_argument("PacketCodec::Encode: value without a code");
  }
  w->at = kFirstSighting;
  w->Bits(1, 1);
  w->Bits(kBearingCode, kTargetBits);
  w->Bits(static_cast<std::uint64_t>(sent.source), kSentSourceBits);
  w->Bits(static_cast<std::uint64_t>(SentAge(s, sent.stamp, w)), kSentAgeBits);
  w->Number(sent_azimuth_, WrapAngle(sent.azimuth_rad), kSentAzimuthBits);
}

void MeasurementPacket::ReadSentBearing(Reader* r, NeighbourState* s) const {
  const auto source = static_cast<int>(r->Bits(kSentSourceBits));
  const TimeNs age = static_cast<TimeNs>(r->Bits(kSentAgeBits)) * age_step_;
  const double azimuth = r->Number(sent_azimuth_, kSentAzimuthBits);
  if (source >= members_) {
    RefusePacket("source " + std::to_string(source) + " of a bearing does not exist");
  }
  if (s->generation - age < 0) RefusePacket("measured before the start");
  s->has_bearing = true;
  s->bearing = {source, s->generation - age, azimuth};
}

void MeasurementPacket::WriteSentRanges(const NeighbourState& s, Writer* w) const {
  w->at = kFirstSighting + (kSightings - 1) * kSightingBits;
  w->Bits(1, 1);
  w->Bits(kRangesCode, kTargetBits);
  for (int k = 0; k < kSentRanges; ++k) {
    if (k >= s.ranges.size()) {
      w->Bits(kNoSource, kSentSourceBits);
      w->at += kSentAgeBits + kSentRangeBits;
      continue;
    }
    const SentRange& sent = s.ranges[k];
    if (sent.source < 0 || sent.source >= members_ || sent.stamp > s.generation ||
        !std::isfinite(sent.range_m)) {
      throw std::invalid_argument("PacketCodec::Encode: value without a code");
    }
    w->Bits(static_cast<std::uint64_t>(sent.source), kSentSourceBits);
    w->Bits(static_cast<std::uint64_t>(SentAge(s, sent.stamp, w)), kSentAgeBits);
    w->Number(sent_range_, sent.range_m, kSentRangeBits);
  }
}

void MeasurementPacket::ReadSentRanges(Reader* r, NeighbourState* s) const {
  for (int k = 0; k < kSentRanges; ++k) {
    const std::uint64_t source = r->Bits(kSentSourceBits);
    const TimeNs age = static_cast<TimeNs>(r->Bits(kSentAgeBits)) * age_step_;
    const double range = r->Number(sent_range_, kSentRangeBits);
    if (source == kNoSource) continue;
    if (static_cast<int>(source) >= members_) {
      RefusePacket("source " + std::to_string(source) + " of a range does not exist");
    }
    if (s->generation - age < 0) RefusePacket("measured before the start");
    s->ranges.push_back({static_cast<int>(source), s->generation - age, range});
  }
}

void MeasurementPacket::WriteSentFix(const NeighbourState& s, Writer* w) const {
  const SentFix& sent = s.fix;
  if (sent.stamp > s.generation || !std::isfinite(sent.error_x + sent.error_y + sent.std_m)) {
    throw std::invalid_argument("PacketCodec::Encode: value without a code");
  }
  w->at = kFirstSighting + (kSightings - 1) * kSightingBits;
  w->Bits(1, 1);
  w->Bits(kFixCode, kTargetBits);
  w->Bits(static_cast<std::uint64_t>(SentAge(s, sent.stamp, w)), kSentAgeBits);
  w->Number(sent_error_, sent.error_x, kSentErrorBits);
  w->Number(sent_error_, sent.error_y, kSentErrorBits);
  w->Bits(sent_std_.Code(sent.std_m, 1.0 - 1e-9, &w->saturated), kSentStdBits);
}

void MeasurementPacket::ReadSentFix(Reader* r, NeighbourState* s) const {
  const TimeNs age = static_cast<TimeNs>(r->Bits(kSentAgeBits)) * age_step_;
  const double x = r->Number(sent_error_, kSentErrorBits);
  const double y = r->Number(sent_error_, kSentErrorBits);
  const double std_m = sent_std_.Value(r->Bits(kSentStdBits));
  if (std_m <= 0.0) RefusePacket("a field holds an unused code");
  if (s->source >= agents_) RefusePacket("a station reports a fix");
  if (s->generation - age < 0) RefusePacket("measured before the start");
  s->has_fix = true;
  s->fix = {s->generation - age, x, y, std_m};
}

void MeasurementPacket::WriteSent(const NeighbourState& s, Writer* w) const {
  if (s.has_fix && !ambiguous_) {
    WriteSentFix(s, w);
  } else if (!s.ranges.empty() && !ambiguous_) {
    WriteSentRanges(s, w);
  }
  if (s.has_bearing && s.sightings.empty()) WriteSentBearing(s, w);
  w->at = kSurfacingBit;
  w->Bits(s.surfacing ? 1 : 0, 1);
}

bool MeasurementPacket::ReadSent(int k, Reader* r, NeighbourState* s) const {
  const bool second = k == kSightings - 1 && !ambiguous_;
  const std::uint64_t code = Get(r->words, {r->at, kTargetBits});
  const bool ranges = second && code == kRangesCode, fix = second && code == kFixCode;
  const bool bearing = k == 0 && code == kBearingCode;
  if (!ranges && !fix && !bearing) return false;
  r->at += kTargetBits;
  if (ranges) ReadSentRanges(r, s);
  if (fix) ReadSentFix(r, s);
  if (bearing) ReadSentBearing(r, s);
  return true;
}

}  // namespace stg::agent

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "auv_common/numbers/attitude.hpp"
#include "measurement_fields.hpp"
#include "stg_agent/packet/measurement_packet.hpp"

/// The items of a packet about own ranges, bearings and fixes, for agents that locate each other.
namespace stg::agent {

TimeNs MeasurementPacket::ToldAge(const NeighbourState& s, TimeNs stamp, Writer* w) const {
  const TimeNs steps = (s.generation - stamp + age_step_ / 2) / age_step_;
  constexpr TimeNs kMost = (1 << kToldAgeBits) - 1;
  w->saturated |= steps > kMost;
  return std::min(steps, kMost);
}

void MeasurementPacket::WriteToldBearing(const NeighbourState& s, Writer* w) const {
  const ToldBearing& told = s.bearing;
  if (told.source < 0 || told.source >= members_ || told.stamp > s.generation ||
      !std::isfinite(told.azimuth_rad)) {
    throw std::invalid_argument("PacketCodec::Encode: value without a code");
  }
  w->at = kFirstSighting;
  w->Bits(1, 1);
  w->Bits(kBearingCode, kTargetBits);
  w->Bits(static_cast<std::uint64_t>(told.source), kToldSourceBits);
  w->Bits(static_cast<std::uint64_t>(ToldAge(s, told.stamp, w)), kToldAgeBits);
  w->Number(told_azimuth_, WrapAngle(told.azimuth_rad), kToldAzimuthBits);
}

void MeasurementPacket::ReadToldBearing(Reader* r, NeighbourState* s) const {
  const auto source = static_cast<int>(r->Bits(kToldSourceBits));
  const TimeNs age = static_cast<TimeNs>(r->Bits(kToldAgeBits)) * age_step_;
  const double azimuth = r->Number(told_azimuth_, kToldAzimuthBits);
  if (source >= members_) {
    RefusePacket("source " + std::to_string(source) + " of a bearing does not exist");
  }
  if (s->generation - age < 0) RefusePacket("measured before the start");
  s->has_bearing = true;
  s->bearing = {source, s->generation - age, azimuth};
}

void MeasurementPacket::WriteToldRanges(const NeighbourState& s, Writer* w) const {
  w->at = kFirstSighting + (kSightings - 1) * kSightingBits;
  w->Bits(1, 1);
  w->Bits(kRangesCode, kTargetBits);
  for (int k = 0; k < kToldRanges; ++k) {
    if (k >= s.ranges.size()) {
      w->Bits(kNoSource, kToldSourceBits);
      w->at += kToldAgeBits + kToldRangeBits;
      continue;
    }
    const ToldRange& told = s.ranges[k];
    if (told.source < 0 || told.source >= members_ || told.stamp > s.generation ||
        !std::isfinite(told.range_m)) {
      throw std::invalid_argument("PacketCodec::Encode: value without a code");
    }
    w->Bits(static_cast<std::uint64_t>(told.source), kToldSourceBits);
    w->Bits(static_cast<std::uint64_t>(ToldAge(s, told.stamp, w)), kToldAgeBits);
    w->Number(told_range_, told.range_m, kToldRangeBits);
  }
}

void MeasurementPacket::ReadToldRanges(Reader* r, NeighbourState* s) const {
  for (int k = 0; k < kToldRanges; ++k) {
    const std::uint64_t source = r->Bits(kToldSourceBits);
    const TimeNs age = static_cast<TimeNs>(r->Bits(kToldAgeBits)) * age_step_;
    const double range = r->Number(told_range_, kToldRangeBits);
    if (source == kNoSource) continue;
    if (static_cast<int>(source) >= members_) {
      RefusePacket("source " + std::to_string(source) + " of a range does not exist");
    }
    if (s->generation - age < 0) RefusePacket("measured before the start");
    s->ranges.push_back({static_cast<int>(source), s->generation - age, range});
  }
}

void MeasurementPacket::WriteToldFix(const NeighbourState& s, Writer* w) const {
  const ToldFix& told = s.fix;
  if (told.stamp > s.generation || !std::isfinite(told.error_x + told.error_y + told.std_m)) {
    throw std::invalid_argument("PacketCodec::Encode: value without a code");
  }
  w->at = kFirstSighting + (kSightings - 1) * kSightingBits;
  w->Bits(1, 1);
  w->Bits(kFixCode, kTargetBits);
  w->Bits(static_cast<std::uint64_t>(ToldAge(s, told.stamp, w)), kToldAgeBits);
  w->Number(told_error_, told.error_x, kToldErrorBits);
  w->Number(told_error_, told.error_y, kToldErrorBits);
  w->Bits(told_std_.Code(told.std_m, 1.0 - 1e-9, &w->saturated), kToldStdBits);
}

void MeasurementPacket::ReadToldFix(Reader* r, NeighbourState* s) const {
  const TimeNs age = static_cast<TimeNs>(r->Bits(kToldAgeBits)) * age_step_;
  const double x = r->Number(told_error_, kToldErrorBits);
  const double y = r->Number(told_error_, kToldErrorBits);
  const double std_m = told_std_.Value(r->Bits(kToldStdBits));
  if (std_m <= 0.0) RefusePacket("a field holds an unused code");
  if (s->source >= agents_) RefusePacket("a station reports a fix");
  if (s->generation - age < 0) RefusePacket("measured before the start");
  s->has_fix = true;
  s->fix = {s->generation - age, x, y, std_m};
}

void MeasurementPacket::WriteTold(const NeighbourState& s, Writer* w) const {
  if (s.has_fix && !ambiguous_) {
    WriteToldFix(s, w);
  } else if (!s.ranges.empty() && !ambiguous_) {
    WriteToldRanges(s, w);
  }
  if (s.has_bearing && s.sightings.empty()) WriteToldBearing(s, w);
  w->at = kSurfacingBit;
  w->Bits(s.surfacing ? 1 : 0, 1);
}

bool MeasurementPacket::ReadTold(int k, Reader* r, NeighbourState* s) const {
  const bool second = k == kSightings - 1 && !ambiguous_;
  const std::uint64_t code = Get(r->words, {r->at, kTargetBits});
  const bool ranges = second && code == kRangesCode, fix = second && code == kFixCode;
  const bool bearing = k == 0 && code == kBearingCode;
  if (!ranges && !fix && !bearing) return false;
  r->at += kTargetBits;
  if (ranges) ReadToldRanges(r, s);
  if (fix) ReadToldFix(r, s);
  if (bearing) ReadToldBearing(r, s);
  return true;
}

}  // namespace stg::agent

#include "stg_agent/packet/measurement_packet.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

#include "auv_common/numbers/attitude.hpp"
#include "auv_dynamics/navigation/navigation_system.hpp"
#include "auv_dynamics/sensing/target_sensor.hpp"
#include "measurement_fields.hpp"

namespace stg::agent {

using dynamics::Detection;
using dynamics::MeasurementKind;

namespace {

constexpr double kPlaceMargin = 1.25;

double Length(const std::array<double, 3>& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

}  // namespace

MeasurementPacket::Logarithm MeasurementPacket::Logarithm::Of(double lo, double hi, int bits) {
  const int codes = (1 << bits) - 1;  // without zero
  const double step = std::log(hi / lo) / (codes - 1);
  return {lo, 1.0 / step, codes, step};
}

std::uint64_t MeasurementPacket::Logarithm::Code(double value, double rounding,
                                                 bool* saturated) const {
  if (value <= 0.0) return 0;
  const double code = 1.0 + std::floor(std::log(value / lo) * inverse + rounding);
  if (code > codes) *saturated = true;
  return static_cast<std::uint64_t>(Clip(code, 1.0, static_cast<double>(codes)));
}

double MeasurementPacket::Logarithm::Value(std::uint64_t code) const {
  return code == 0 ? 0.0 : lo * std::exp(step * static_cast<double>(code - 1));
}

MeasurementPacket::MeasurementPacket(const AgentModel& s)
    : agents_(s.run.agents),
      targets_(s.target.count),
      free_(s.task.free()),
      located_(s.locates()),
      version_(located_ ? kLocatedVersion
               : free_  ? kFreeVersion
                        : kMeasurementVersion),
      members_(s.run.agents + (located_ ? s.stations.count() : 0)),
      sensing_(s.sensing),
      relative_(s.sensing.relative()) {
  const double half = s.workspace.half_extent_m;
  const double current = s.max_current_mps;
  const double speed = Length(s.vehicle.max_velocity_mps) + current;
  const double longest = std::min(s.track.memory_s, 127.0 * s.run.decision_dt_s());
  const auto sensor =
      dynamics::TargetSensors().Make(s.sensing.sensor, s.sensing.sensors, s.sensing);
  const auto navigation = dynamics::NavigationSystems().Make(
      s.navigation.kind, s.navigation.kinds,
      {s.navigation, s.run.agents, s.run.time.dt_s, s.navigation});
  kind_ = sensor->kind();
  ambiguous_ = relative_.ambiguous &&
               (kind_ == MeasurementKind::kBearing || kind_ == MeasurementKind::kRangeBearing);
  const double degree = kPi / 180.0;
  heading_variance_ = heading_walk_ = 0.0;
  if (!navigation->perfect()) {
    heading_variance_ = std::pow(s.navigation.heading_std_deg * degree, 2);
    heading_walk_ = std::pow(s.navigation.gyro_walk_deg_per_sqrt_h * degree, 2) / 3600.0;
  }
  age_step_ = std::max<TimeNs>(1, s.run.decision_period() / 8);
  position_ = Quantiser::Signed(kPlaceMargin * half, kPlaceBits);
  velocity_ = Quantiser::Signed(speed, kSpeedBits);
  unit_ = Quantiser::Unsigned(0.0, 1.0, kUnitBits);
  offset_ = Quantiser::Signed(speed * longest, kOffsetBits);
  rise_ = Quantiser::Signed((s.vehicle.max_velocity_mps[2] + current) * longest, kRiseBits);
  range_ = Quantiser::Unsigned(0.0, 1.25 * s.sensing.range_m, free_ ? kFreeRangeBits : kRangeBits);
  azimuth_ = Quantiser::Signed(kPi, kAzimuthBits);
  elevation_ = Quantiser::Signed(2.0, kElevationBits);
  fine_azimuth_ = Quantiser::Signed(kPi, kFineAzimuthBits);
  fine_elevation_ = Quantiser::Signed(2.0, kFineElevationBits);
  sent_azimuth_ = Quantiser::Signed(kPi, kSentAzimuthBits);
  sent_range_ = Quantiser::Unsigned(kLeastRange_m, kMostRange_m, kSentRangeBits);
  sent_error_ = Quantiser::Signed(kMostError_m, kSentErrorBits);
  sent_std_ = Logarithm::Of(kLeastFixStd_m, kMostFixStd_m, kSentStdBits);
  deviation_ = Logarithm::Of(1e-5 * half, half, located_ ? kLocatedDeviationBits : kDeviationBits);
  error_ = Logarithm::Of(1e-4 * half, 2.0 * std::sqrt(3.0) * half, kErrorBits);
}

Packet MeasurementPacket::Encode(const NeighbourState& s) const {
  if (!Finite(s.p_W) || !Finite(s.v_W) ||
      !std::isfinite(s.confidence + s.tracking_error + s.link_quality + s.position_std_m)) {
    throw std::invalid_argument("PacketCodec::Encode: non-finite value");
  }
  if (s.source < 0 || s.source >= members_ || s.phase < 0 || s.phase > 3 || s.generation < 0 ||
      s.sightings.size() > (free_ ? kFreeSightings : kSightings) || s.followed >= targets_) {
    throw std::invalid_argument("PacketCodec::Encode: value without a code");
  }
  Writer w;
  w.Bits(version_, 4);
  w.Bits(static_cast<std::uint64_t>(s.source), kSourceBits);
  w.Bits(static_cast<std::uint64_t>(Ticks(s.generation)) & ((1U << kGenerationBits) - 1),
         kGenerationBits);
  WritePlace(s.p_W, &w);
  w.Vector(velocity_, s.v_W, kSpeedBits);
  w.Bits(deviation_.Code(s.position_std_m, 1.0 - 1e-9, &w.saturated),
         located_ ? kLocatedDeviationBits : kDeviationBits);
  if (located_) w.Bits(s.adrift ? 1 : 0, 1);
  w.Bits(error_.Code(s.tracking_error, 0.5, &w.saturated), kErrorBits);
  w.Number(unit_, s.confidence, kUnitBits);
  w.Bits(static_cast<std::uint64_t>(s.phase), 2);
  w.Number(unit_, s.link_quality, kUnitBits);
  const int saturated_bit = w.at;
  if (free_) {
    w.at = kFirstSighting;
    WriteFree(s, &w);
  } else if (s.has_target) {
    const bool taken = located_ && (!s.ranges.empty() || s.has_fix);
    const int fit = ambiguous_ || taken ? 1 : kSightings;
    for (int k = 0; k < std::min(s.sightings.size(), fit); ++k) {
      w.at = kFirstSighting + k * kSightingBits;
      WriteSighting(s, s.sightings[k], &w);
    }
  }
  if (located_) WriteSent(s, &w);
  w.at = saturated_bit;
  w.Bits(w.saturated ? 1 : 0, 1);
  w.at = kCrcFirst;
  w.Bits(Checksum(w.words), 8);
  Packet packet;
  std::memcpy(packet.data(), w.words.data(), packet.size());
  return packet;
}

void MeasurementPacket::WritePlace(const Vec3<double>& p, Writer* w) const {
  if (!located_) {
    w->Vector(position_, p, kPlaceBits);
    return;
  }
  for (const double x : {p.x, p.y}) {
    const auto code = static_cast<std::int64_t>(std::floor(x * position_.inverse + 0.5));
    w->Bits(static_cast<std::uint64_t>(code) & ((1U << kPlaceBits) - 1), kPlaceBits);
  }
  w->Number(position_, p.z, kPlaceBits);
}

Vec3<double> MeasurementPacket::ReadPlace(const Vec3<double>& near, Reader* r) const {
  if (!located_) return r->Vector(position_, kPlaceBits);
  const auto nearest = [&](double to) {
    const double x = static_cast<double>(r->Bits(kPlaceBits)) * position_.resolution;
    const double region = static_cast<double>(1U << kPlaceBits) * position_.resolution;
    return x + region * std::floor((to - x) / region + 0.5);
  };
  const double x = nearest(near.x), y = nearest(near.y);
  return {x, y, r->Number(position_, kPlaceBits)};
}

void MeasurementPacket::RequireCode(const NeighbourState& s, const Detection& d) const {
  if (d.target < 0 || d.target >= targets_ || d.kind != kind_ || d.stamp > s.generation) {
    throw std::invalid_argument("PacketCodec::Encode: value without a code");
  }
}

TimeNs MeasurementPacket::AgeCode(const NeighbourState& s, const Detection& d) const {
  return (s.generation - d.stamp + age_step_ / 2) / age_step_;
}

void MeasurementPacket::WriteAge(TimeNs steps, int bits, Writer* w) {
  const TimeNs most = (TimeNs{1} << bits) - 1;
  w->saturated |= steps > most;
  w->Bits(static_cast<std::uint64_t>(std::min(steps, most)), bits);
}

void MeasurementPacket::WriteObserver(const NeighbourState& s, const Detection& d,
                                      Writer* w) const {
  const Vec3<double> offset = d.p_WO - s.p_W;
  w->Number(offset_, offset.x, kOffsetBits);
  w->Number(offset_, offset.y, kOffsetBits);
  w->Number(rise_, offset.z, kRiseBits);
}

Vec3<double> MeasurementPacket::ReadObserver(const NeighbourState& s, Reader* r) const {
  const double x = r->Number(offset_, kOffsetBits), y = r->Number(offset_, kOffsetBits);
  return s.p_W + Vec3<double>{x, y, r->Number(rise_, kRiseBits)};
}

void MeasurementPacket::WriteSighting(const NeighbourState& s, const Detection& d,
                                      Writer* w) const {
  RequireCode(s, d);
  w->Bits(1, 1);
  w->Bits(static_cast<std::uint64_t>(d.target), kTargetBits);
  WriteMeasured(s, d, w);
}

void MeasurementPacket::WriteMeasured(const NeighbourState& s, const Detection& d,
                                      Writer* w) const {
  WriteAge(AgeCode(s, d), kAgeBits, w);
  const bool point = kind_ == MeasurementKind::kPosition || kind_ == MeasurementKind::kRangeBearing;
  if (point && !ambiguous_) {
    WritePlace(d.p_WT, w);
    return;
  }
  WriteObserver(s, d, w);
  if (ambiguous_) {
    w->Number(range_, d.range_m, kRangeBits);
    w->Number(fine_azimuth_, WrapAngle(d.azimuth_rad), kFineAzimuthBits);
    w->Number(fine_elevation_, d.elevation_rad, kFineElevationBits);
    w->Number(fine_azimuth_, WrapAngle(d.mirror_azimuth_rad), kFineAzimuthBits);
  } else if (kind_ == MeasurementKind::kRange) {
    w->Number(range_, d.range_m, kRangeBits);
  } else {
    w->Number(azimuth_, WrapAngle(d.azimuth_rad), kAzimuthBits);
    w->Number(elevation_, d.elevation_rad, kElevationBits);
  }
}

NeighbourState MeasurementPacket::Decode(const std::uint8_t* data, std::size_t size, TimeNs now,
                                         const Vec3<double>& near) const {
  if (size != kPacketBytes) {
    RefusePacket(std::to_string(size) + " bytes instead of " + std::to_string(kPacketBytes));
  }
  Reader r;
  std::memcpy(r.words.data(), data, size);
  if (Checksum(r.words) != Get(r.words, {kCrcFirst, 8})) RefusePacket("wrong checksum");
  const std::uint64_t version = r.Bits(4);
  if (version != version_) {
    RefusePacket("version " + std::to_string(version) + " is unknown");
  }
  NeighbourState s;
  s.source = static_cast<int>(r.Bits(kSourceBits));
  if (s.source >= members_) RefusePacket("source " + std::to_string(s.source) + " does not exist");
  const std::int64_t ticks = Ticks(now);
  const std::int64_t behind = (ticks - static_cast<std::int64_t>(r.Bits(kGenerationBits))) &
                              ((std::int64_t{1} << kGenerationBits) - 1);
  if (ticks - behind < 0) RefusePacket("generated after the receiver's clock");
  s.generation = std::min((ticks - behind) * kTick, now);
  s.p_W = ReadPlace(near, &r);
  s.v_W = r.Vector(velocity_, kSpeedBits);
  s.position_std_m = deviation_.Value(r.Bits(located_ ? kLocatedDeviationBits : kDeviationBits));
  if (located_) s.adrift = r.Bits(1) != 0;
  s.tracking_error = error_.Value(r.Bits(kErrorBits));
  s.confidence = r.Number(unit_, kUnitBits);
  s.phase = static_cast<int>(r.Bits(2));
  s.link_quality = r.Number(unit_, kUnitBits);
  s.saturated = r.Bits(1) != 0;
  const int fit = free_ ? 0 : ambiguous_ ? 1 : kSightings;
  if (free_) ReadFree(&r, &s);
  for (int k = 0; k < fit; ++k) {
    r.at = kFirstSighting + k * kSightingBits;
    if (r.Bits(1) == 0) continue;
    if (located_ && ReadSent(k, &r, &s)) continue;
    ReadSighting(s, &r, &s.sightings.push_back({}));
  }
  if (located_) s.surfacing = Get(r.words, {kSurfacingBit, 1}) != 0;
  s.has_target = !s.sightings.empty();
  if (!free_) s.followed = s.source % targets_;
  if (s.has_target) {
    s.target = s.sightings[0].target;
    s.target_stamp = s.sightings[0].stamp;
  }
  if (r.unused_code) RefusePacket("a field holds an unused code");
  return s;
}

void MeasurementPacket::ReadSighting(const NeighbourState& s, Reader* r, Detection* d) const {
  const int target = static_cast<int>(r->Bits(kTargetBits));
  if (target >= targets_) RefusePacket("target " + std::to_string(target) + " does not exist");
  ReadMeasured(s, target, r, d);
}

void MeasurementPacket::ReadMeasured(const NeighbourState& s, int target, Reader* r,
                                     Detection* d) const {
  *d = Detection();
  d->kind = kind_;
  d->ambiguous = ambiguous_;
  d->target = target;
  const TimeNs age = static_cast<TimeNs>(r->Bits(kAgeBits)) * age_step_;
  d->stamp = s.generation - age;
  if (d->stamp < 0) RefusePacket("measured before the start");
  const bool point = kind_ == MeasurementKind::kPosition || kind_ == MeasurementKind::kRangeBearing;
  if (point && !ambiguous_) {
    d->p_WT = ReadPlace(s.p_W, r);
    // The packet does not contain the observer's position. Only the directions of the deviations
    // depend on it.
    d->p_WO = s.p_W - s.v_W * Seconds(age);
    const Vec3<double> line = d->p_WT - d->p_WO;
    d->range_m = Norm(line);
    d->azimuth_rad = std::atan2(line.y, line.x);
    d->elevation_rad = std::atan2(line.z, std::hypot(line.x, line.y));
  } else {
    d->p_WO = ReadObserver(s, r);
    d->p_WT = d->p_WO;
    if (ambiguous_) {
      d->range_m = r->Number(range_, kRangeBits);
      d->azimuth_rad = r->Number(fine_azimuth_, kFineAzimuthBits);
      d->elevation_rad = r->Number(fine_elevation_, kFineElevationBits);
      d->mirror_azimuth_rad = r->Number(fine_azimuth_, kFineAzimuthBits);
    } else if (kind_ == MeasurementKind::kRange) {
      d->range_m = r->Number(range_, kRangeBits);
    } else {
      d->azimuth_rad = r->Number(azimuth_, kAzimuthBits);
      d->elevation_rad = r->Number(elevation_, kElevationBits);
    }
  }
  SetDeviations(s, d);
}

void MeasurementPacket::SetDeviations(const NeighbourState& s, Detection* d) const {
  d->p_WO_std_m = s.position_std_m;
  d->heading_std_rad = std::sqrt(heading_variance_ + heading_walk_ * Seconds(d->stamp));
  d->bearing_std_rad = kind_ == MeasurementKind::kBearing || kind_ == MeasurementKind::kRangeBearing
                           ? relative_.bearing_std_deg * kPi / 180.0
                           : 0.0;
  d->range_std_m = kind_ == MeasurementKind::kRange || kind_ == MeasurementKind::kRangeBearing
                       ? relative_.range_std(d->range_m)
                       : 0.0;
  d->std_m = kind_ == MeasurementKind::kPosition
                 ? sensing_.noise_std_m
                 : std::max(d->range_std_m, d->range_m * d->bearing_std_rad);
}

}  // namespace stg::agent

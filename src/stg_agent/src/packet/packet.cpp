#include "stg_agent/packet/packet.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

#include "auv_common/error.hpp"
#include "bits.hpp"

namespace stg::agent {
namespace {

constexpr std::uint64_t kVersion = 1;
constexpr int kPositionBits = 15, kVelocityBits = 12, kTargetVelocityBits = 11;
constexpr Bits kVersionBits{0, 4};
constexpr Bits kSource = After(kVersionBits, 8);
constexpr Bits kGeneration = After(kSource, 16);
constexpr Bits kPosition = After(kGeneration, 3 * kPositionBits);
constexpr Bits kVelocity = After(kPosition, 3 * kVelocityBits);
constexpr Bits kConfidence = After(kVelocity, 7);
constexpr Bits kError = After(kConfidence, 14);
constexpr Bits kPhase = After(kError, 2);
constexpr Bits kQuality = After(kPhase, 7);
constexpr Bits kSaturated = After(kQuality, 1);
constexpr Bits kHasTarget = After(kSaturated, 1);
constexpr Bits kTarget = After(kHasTarget, 6);
constexpr Bits kAge = After(kTarget, 15);
constexpr Bits kTargetPosition = After(kAge, 3 * kPositionBits);
constexpr Bits kTargetVelocity = After(kTargetPosition, 3 * kTargetVelocityBits);
constexpr Bits kStd = After(kTargetVelocity, 8);
constexpr Bits kCrcBits = After(kStd, 8);
static_assert(kCrcBits.end() == 8 * kPacketBytes, "the fields fill the packet");
static_assert(kConfidence.count == kQuality.count, "one quantiser serves the unit interval");

constexpr std::int64_t kMaxAge = (1 << kAge.count) - 1;
constexpr double kPositionMargin = 1.25;  // noisy target estimates may be outside of the walls
constexpr double kTargetSpeedMargin = 2.0;
constexpr double kStdLo = 1e-5, kStdHi = 10.0;  // share of the workspace's half extent

/// Zero when all components are finite, NaN otherwise.
double Finiteness(const Vec3<double>& v) { return v.x * 0.0 + v.y * 0.0 + v.z * 0.0; }

double SpeedLimit(const AgentModel& s) {
  const auto& v = s.vehicle.max_velocity_mps;
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + s.max_current_mps;
}

double TargetSpeedLimit(const AgentModel& s) {
  // A filter that starts without a velocity must be able to send its estimate.
  return std::max(
      {kTargetSpeedMargin * s.target.max_speed_mps, 4.0 * s.track.initial_speed_std_mps, 1e-3});
}

[[noreturn, gnu::noinline, gnu::cold]] void Refuse(const std::string& why) {
  throw UserError("packet: " + why);
}

}  // namespace

PacketCodec::PacketCodec(const AgentModel& s, PacketLayout layout)
    : layout_(layout),
      agents_(s.run.agents),
      targets_(s.target.count),
      free_(s.task.free()),
      position_(Quantiser::Signed(kPositionMargin * s.workspace.half_extent_m, kPositionBits)),
      velocity_(Quantiser::Signed(SpeedLimit(s), kVelocityBits)),
      unit_(Quantiser::Unsigned(0.0, 1.0, kConfidence.count)),
      error_(
          Quantiser::Unsigned(0.0, 2.0 * std::sqrt(3.0) * s.workspace.half_extent_m, kError.count)),
      target_velocity_(Quantiser::Signed(TargetSpeedLimit(s), kTargetVelocityBits)),
      log_std_(Quantiser::Unsigned(std::log(kStdLo * s.workspace.half_extent_m),
                                   std::log(kStdHi * s.workspace.half_extent_m), kStd.count)),
      measurements_(s) {
  if (agents_ < 1 || agents_ > 1 << kSource.count) {
    throw UserError("agents: a packet can name 1 to 256 AUVs, not " + std::to_string(agents_));
  }
  if (targets_ < 1 || targets_ > 1 << kTarget.count) {
    throw UserError("target.count: a packet can name 1 to 64 targets, not " +
                    std::to_string(targets_));
  }
  for (std::size_t i = 0; i < std_of_code_.size(); ++i) {
    bool unused_code = false;
    std_of_code_[i] = std::exp(Value(log_std_, i, &unused_code));
  }
}

Packet PacketCodec::Encode(const NeighbourState& s) const {
  return layout_ == PacketLayout::kEstimate ? EncodeEstimate(s) : measurements_.Encode(s);
}

NeighbourState PacketCodec::Decode(const std::uint8_t* data, std::size_t size, TimeNs now,
                                   const Vec3<double>& near) const {
  return layout_ == PacketLayout::kEstimate ? DecodeEstimate(data, size, now)
                                            : measurements_.Decode(data, size, now, near);
}

int PacketCodec::SourceOf(const std::uint8_t* data, std::size_t size) {
  if (size != kPacketBytes) return -1;
  Words w;
  std::memcpy(w.data(), data, size);
  return static_cast<int>(Get(w, kSource));
}

Packet PacketCodec::EncodeEstimate(const NeighbourState& s) const {
  double finite = Finiteness(s.p_W) + Finiteness(s.v_W) +
                  (s.confidence + s.tracking_error + s.link_quality) * 0.0;
  bool valid =
      s.source >= 0 && s.source < agents_ && s.phase >= 0 && s.phase < 4 && s.generation >= 0;
  if (s.has_target) {
    finite += Finiteness(s.p_WT) + Finiteness(s.v_WT) + s.target_std * 0.0;
    valid = valid && s.target >= 0 && s.target < targets_ && s.target_std >= 0.0;
  }
  if (!(finite == 0.0)) throw std::invalid_argument("PacketCodec::Encode: non-finite value");
  if (!valid) throw std::invalid_argument("PacketCodec::Encode: value without a code");

  bool saturated = false;
  Words w{};
  const std::int64_t generation = Ticks(s.generation);
  Put(&w, kVersionBits, kVersion);
  Put(&w, kSource, static_cast<std::uint64_t>(s.source));
  Put(&w, kGeneration, static_cast<std::uint64_t>(generation) & ((1u << kGeneration.count) - 1));
  PutVector(&w, kPosition, position_, s.p_W, &saturated);
  PutVector(&w, kVelocity, velocity_, s.v_W, &saturated);
  Put(&w, kConfidence, Code(unit_, s.confidence, &saturated));
  Put(&w, kError, Code(error_, s.tracking_error, &saturated));
  Put(&w, kPhase, static_cast<std::uint64_t>(s.phase));
  Put(&w, kQuality, Code(unit_, s.link_quality, &saturated));
  if (s.has_target) {
    // Both stamps are rounded before the subtraction: each is within half a tick.
    const std::int64_t age = generation - Ticks(s.target_stamp);
    const std::int64_t clipped = std::min(std::max<std::int64_t>(age, 0), kMaxAge);
    saturated |= clipped != age;
    Put(&w, kHasTarget, 1);
    Put(&w, kTarget, static_cast<std::uint64_t>(s.target));
    Put(&w, kAge, static_cast<std::uint64_t>(clipped));
    PutVector(&w, kTargetPosition, position_, s.p_WT, &saturated);
    PutVector(&w, kTargetVelocity, target_velocity_, s.v_WT, &saturated);
    Put(&w, kStd, Code(log_std_, std::log(s.target_std), &saturated));
  }
  Put(&w, kSaturated, saturated ? 1 : 0);
  Put(&w, kCrcBits, Checksum(w));

  Packet packet;
  std::memcpy(packet.data(), w.data(), packet.size());
  return packet;
}

NeighbourState PacketCodec::DecodeEstimate(const std::uint8_t* data, std::size_t size,
                                           TimeNs now) const {
  if (size != kPacketBytes) {
    Refuse(std::to_string(size) + " bytes instead of " + std::to_string(kPacketBytes));
  }
  Words w;
  std::memcpy(w.data(), data, size);
  if (Checksum(w) != Get(w, kCrcBits)) Refuse("wrong checksum");
  const std::uint64_t version = Get(w, kVersionBits);
  if (version != kVersion) Refuse("version " + std::to_string(version) + " is unknown");

  NeighbourState s;
  bool unused_code = false;
  s.source = static_cast<int>(Get(w, kSource));
  if (s.source >= agents_) Refuse("source " + std::to_string(s.source) + " does not exist");
  const std::int64_t ticks_now = Ticks(now);
  const std::int64_t behind = (ticks_now - static_cast<std::int64_t>(Get(w, kGeneration))) &
                              ((std::int64_t{1} << kGeneration.count) - 1);
  const std::int64_t generation = ticks_now - behind;
  if (generation < 0) Refuse("generated after the receiver's clock");
  s.generation = std::min(generation * kTick, now);
  s.p_W = GetVector(w, kPosition, position_, &unused_code);
  s.v_W = GetVector(w, kVelocity, velocity_, &unused_code);
  s.confidence = Value(unit_, Get(w, kConfidence), &unused_code);
  s.tracking_error = Value(error_, Get(w, kError), &unused_code);
  s.phase = static_cast<int>(Get(w, kPhase));
  s.link_quality = Value(unit_, Get(w, kQuality), &unused_code);
  s.saturated = Get(w, kSaturated) != 0;
  s.has_target = Get(w, kHasTarget) != 0;
  if (s.has_target) {
    s.target = static_cast<int>(Get(w, kTarget));
    if (s.target >= targets_) Refuse("target " + std::to_string(s.target) + " does not exist");
    const auto age = static_cast<std::int64_t>(Get(w, kAge));
    s.target_stamp = std::min((generation - age) * kTick, s.generation);
    s.p_WT = GetVector(w, kTargetPosition, position_, &unused_code);
    s.v_WT = GetVector(w, kTargetVelocity, target_velocity_, &unused_code);
    s.target_std = std_of_code_[Get(w, kStd)];
  }
  s.followed = !free_ ? s.source % targets_ : s.has_target ? s.target : -1;
  if (unused_code) Refuse("a field holds an unused code");
  return s;
}

std::array<PacketField, PacketCodec::kFieldCount> PacketCodec::fields() const {
  const auto field = [](const char* name, int bits, const Quantiser& q) {
    return PacketField{name, bits, q.lo, q.hi, q.resolution};
  };
  return {{field("position", kPositionBits, position_), field("velocity", kVelocityBits, velocity_),
           field("confidence", kConfidence.count, unit_),
           field("tracking_error", kError.count, error_),
           field("link_quality", kQuality.count, unit_),
           field("target_position", kPositionBits, position_),
           field("target_velocity", kTargetVelocityBits, target_velocity_),
           field("log_target_std", kStd.count, log_std_)}};
}

}  // namespace stg::agent

#include "acoustic_channel/packet.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "auv_dynamics/error.hpp"

namespace stg {
namespace {

constexpr std::uint64_t kVersion = 1;
constexpr int kVersionBits = 4, kSourceBits = 8, kGenerationBits = 16, kPositionBits = 15,
              kVelocityBits = 12, kUnitBits = 7, kErrorBits = 14, kPhaseBits = 2, kFlagBits = 1,
              kTargetBits = 6, kAgeBits = 15, kTargetVelocityBits = 11, kStdBits = 8, kCrcBits = 8;
static_assert(kVersionBits + kSourceBits + kGenerationBits + 6 * kPositionBits + 3 * kVelocityBits +
                      2 * kUnitBits + kErrorBits + kPhaseBits + 2 * kFlagBits + kTargetBits +
                      kAgeBits + 3 * kTargetVelocityBits + kStdBits + kCrcBits ==
                  8 * kPacketBytes,
              "the fields fill the packet");

constexpr TimeNs kTick = 1'000'000;  // resolution of both times [ns]
constexpr std::int64_t kMaxAge = (1 << kAgeBits) - 1;
constexpr double kPositionMargin = 1.25;  // noisy target estimates lie outside the walls
constexpr double kTargetSpeedMargin = 2.0;
constexpr double kStdLo = 1e-5, kStdHi = 10.0;  // of the workspace half extent

constexpr int kWords = kPacketBytes / 8;
using Words = std::array<std::uint64_t, kWords>;

/// Tables for eight bytes at a time: kCrc[k][b] is the checksum of byte b and k zero bytes.
/// Bits are taken least significant first, so that the first bit of the version is the highest
/// power: the one pair of bits that the polynomial's period of 255 hides contains that bit, and
/// the version check sees it.
struct CrcTables {
  std::uint8_t t[8][256];
};
constexpr CrcTables MakeCrcTables() {
  CrcTables tables{};
  for (int b = 0; b < 256; ++b) {
    unsigned crc = static_cast<unsigned>(b);
    for (int i = 0; i < 8; ++i) crc = (crc >> 1) ^ ((crc & 1u) ? 0xB8u : 0u);  // 0x1D reversed
    tables.t[0][b] = static_cast<std::uint8_t>(crc);
  }
  for (int k = 1; k < 8; ++k) {
    for (int b = 0; b < 256; ++b) tables.t[k][b] = tables.t[0][tables.t[k - 1][b]];
  }
  return tables;
}
constexpr CrcTables kCrc = MakeCrcTables();

/// CRC-8 of all bytes but the last, which holds it.
std::uint8_t Checksum(const Words& words) {
  std::uint64_t crc = 0xFF;  // a packet of zeros is damaged
  for (int w = 0; w < kWords; ++w) {
    const std::uint64_t x = words[static_cast<std::size_t>(w)] ^ crc;
    const int bytes = w + 1 < kWords ? 8 : 7;
    crc = 0;
    for (int i = 0; i < bytes; ++i) crc ^= kCrc.t[bytes - 1 - i][(x >> (8 * i)) & 0xFF];
  }
  return static_cast<std::uint8_t>(crc);
}

/// Writes fields one after the other, least significant bit first.
class BitWriter {
 public:
  void Put(std::uint64_t code, int bits) {
    const int word = position_ / 64, shift = position_ % 64;
    words[static_cast<std::size_t>(word)] |= code << shift;
    if (shift + bits > 64) words[static_cast<std::size_t>(word + 1)] |= code >> (64 - shift);
    position_ += bits;
  }
  Words words{};

 private:
  int position_ = 0;
};

class BitReader {
 public:
  explicit BitReader(const Words& words) : words_(words) {}
  std::uint64_t Get(int bits) {
    const int word = position_ / 64, shift = position_ % 64;
    std::uint64_t code = words_[static_cast<std::size_t>(word)] >> shift;
    if (shift + bits > 64) code |= words_[static_cast<std::size_t>(word + 1)] << (64 - shift);
    position_ += bits;
    return code & ((std::uint64_t{1} << bits) - 1);
  }

 private:
  const Words& words_;
  int position_ = 0;
};

/// Nearest tick, halves upwards; monotone, so that generation <= now survives the rounding.
std::int64_t Ticks(TimeNs t) {
  const TimeNs shifted = t + kTick / 2;
  return shifted / kTick - (shifted % kTick < 0 ? 1 : 0);
}

/// Zero when all components are finite, NaN otherwise.
double Finiteness(const Vec3<double>& v) { return v.x * 0.0 + v.y * 0.0 + v.z * 0.0; }

double CurrentSpeed(const Scenario& s) {
  const auto& v = s.current.velocity_mps;
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

double SpeedLimit(const Scenario& s) {
  const auto& v = s.vehicle.max_velocity_mps;
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + CurrentSpeed(s);
}

double TargetSpeedLimit(const Scenario& s) {
  // A filter that starts with no velocity must be able to say what it believes.
  return std::max(
      {kTargetSpeedMargin * s.target.max_speed_mps, 4.0 * s.track.initial_speed_std_mps, 1e-3});
}

template <class Q>
std::uint64_t Code(const Q& q, double value, bool* saturated) {
  const double code = std::floor((value - q.lo) * q.inverse + 0.5);
  const double clipped = std::min(std::max(code, 0.0), q.steps);
  *saturated |= clipped != code;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(clipped));
}

template <class Q>
double Value(const Q& q, std::uint64_t code) {
  const double c = static_cast<double>(static_cast<std::int64_t>(code));
  if (c > q.steps) throw UserError("packet: unused field code");
  return std::min(std::max(q.middle + (c - 0.5 * q.steps) * q.resolution, q.lo), q.hi);
}

template <class Q>
void PutVector(BitWriter* w, const Q& q, const Vec3<double>& v, int bits, bool* saturated) {
  w->Put(Code(q, v.x, saturated), bits);
  w->Put(Code(q, v.y, saturated), bits);
  w->Put(Code(q, v.z, saturated), bits);
}

template <class Q>
Vec3<double> GetVector(BitReader* r, const Q& q, int bits) {
  Vec3<double> v;
  v.x = Value(q, r->Get(bits));
  v.y = Value(q, r->Get(bits));
  v.z = Value(q, r->Get(bits));
  return v;
}

[[noreturn]] void Refuse(const std::string& why) { throw UserError("packet: " + why); }

}  // namespace

PacketCodec::Quantiser PacketCodec::Signed(double limit, int bits) {
  Quantiser q;
  q.steps = static_cast<double>((1 << bits) - 2);
  q.resolution = 2.0 * limit / q.steps;
  q.lo = -limit;
  q.hi = limit;
  q.middle = 0.0;
  q.inverse = 1.0 / q.resolution;
  return q;
}

PacketCodec::Quantiser PacketCodec::Unsigned(double lo, double hi, int bits) {
  Quantiser q;
  q.steps = static_cast<double>((1 << bits) - 1);
  q.resolution = (hi - lo) / q.steps;
  q.lo = lo;
  q.hi = hi;
  q.middle = 0.5 * (lo + hi);
  q.inverse = 1.0 / q.resolution;
  return q;
}

PacketCodec::PacketCodec(const Scenario& s)
    : agents_(s.agents),
      targets_(s.target.count),
      position_(Signed(kPositionMargin * s.workspace.half_extent_m, kPositionBits)),
      velocity_(Signed(SpeedLimit(s), kVelocityBits)),
      unit_(Unsigned(0.0, 1.0, kUnitBits)),
      error_(Unsigned(0.0, 2.0 * std::sqrt(3.0) * s.workspace.half_extent_m, kErrorBits)),
      target_velocity_(Signed(TargetSpeedLimit(s), kTargetVelocityBits)),
      log_std_(Unsigned(std::log(kStdLo * s.workspace.half_extent_m),
                        std::log(kStdHi * s.workspace.half_extent_m), kStdBits)) {
  if (agents_ < 1 || agents_ > 1 << kSourceBits) {
    throw UserError("agents: a packet can name 1 to 256 AUVs, not " + std::to_string(agents_));
  }
  if (targets_ < 1 || targets_ > 1 << kTargetBits) {
    throw UserError("target.count: a packet can name 1 to 64 targets, not " +
                    std::to_string(targets_));
  }
  for (std::size_t i = 0; i < std_of_code_.size(); ++i) {
    std_of_code_[i] = std::exp(Value(log_std_, i));
  }
}

Packet PacketCodec::Encode(const NeighbourState& s) const {
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
  BitWriter w;
  w.Put(kVersion, kVersionBits);
  w.Put(static_cast<std::uint64_t>(s.source), kSourceBits);
  const std::int64_t generation = Ticks(s.generation);
  w.Put(static_cast<std::uint64_t>(generation) & ((1u << kGenerationBits) - 1), kGenerationBits);
  PutVector(&w, position_, s.p_W, kPositionBits, &saturated);
  PutVector(&w, velocity_, s.v_W, kVelocityBits, &saturated);
  w.Put(Code(unit_, s.confidence, &saturated), kUnitBits);
  w.Put(Code(error_, s.tracking_error, &saturated), kErrorBits);
  w.Put(static_cast<std::uint64_t>(s.phase), kPhaseBits);
  w.Put(Code(unit_, s.link_quality, &saturated), kUnitBits);
  BitWriter target;
  if (s.has_target) {
    // Both stamps are rounded before they are subtracted: each is within half a tick.
    const std::int64_t age = generation - Ticks(s.target_stamp);
    const std::int64_t clipped = std::min(std::max<std::int64_t>(age, 0), kMaxAge);
    saturated |= clipped != age;
    target.Put(static_cast<std::uint64_t>(s.target), kTargetBits);
    target.Put(static_cast<std::uint64_t>(clipped), kAgeBits);
    PutVector(&target, position_, s.p_WT, kPositionBits, &saturated);
    PutVector(&target, target_velocity_, s.v_WT, kTargetVelocityBits, &saturated);
    target.Put(Code(log_std_, std::log(s.target_std), &saturated), kStdBits);
  }
  w.Put(saturated ? 1 : 0, kFlagBits);
  w.Put(s.has_target ? 1 : 0, kFlagBits);
  constexpr int kTargetBlock =
      kTargetBits + kAgeBits + 3 * kPositionBits + 3 * kTargetVelocityBits + kStdBits;
  w.Put(target.words[0], 64);
  w.Put(target.words[1], kTargetBlock - 64);
  w.words[kWords - 1] |= static_cast<std::uint64_t>(Checksum(w.words)) << 56;

  Packet packet;
  for (std::size_t i = 0; i < packet.size(); ++i) {
    packet[i] = static_cast<std::uint8_t>(w.words[i / 8] >> (8 * (i % 8)));
  }
  return packet;
}

NeighbourState PacketCodec::Decode(const std::uint8_t* data, std::size_t size, TimeNs now) const {
  if (size != kPacketBytes) {
    Refuse(std::to_string(size) + " bytes instead of " + std::to_string(kPacketBytes));
  }
  Words words{};
  for (std::size_t i = 0; i < size; ++i) {
    words[i / 8] |= static_cast<std::uint64_t>(data[i]) << (8 * (i % 8));
  }
  if (Checksum(words) != words[kWords - 1] >> 56) Refuse("wrong checksum");
  BitReader r(words);
  const std::uint64_t version = r.Get(kVersionBits);
  if (version != kVersion) Refuse("version " + std::to_string(version) + " is unknown");

  NeighbourState s;
  s.source = static_cast<int>(r.Get(kSourceBits));
  if (s.source >= agents_) Refuse("source " + std::to_string(s.source) + " does not exist");
  const std::int64_t ticks_now = Ticks(now);
  const std::int64_t behind = (ticks_now - static_cast<std::int64_t>(r.Get(kGenerationBits))) &
                              ((std::int64_t{1} << kGenerationBits) - 1);
  const std::int64_t generation = ticks_now - behind;
  if (generation < 0) Refuse("generated after the receiver's clock");
  s.generation = std::min(generation * kTick, now);
  s.p_W = GetVector(&r, position_, kPositionBits);
  s.v_W = GetVector(&r, velocity_, kVelocityBits);
  s.confidence = Value(unit_, r.Get(kUnitBits));
  s.tracking_error = Value(error_, r.Get(kErrorBits));
  s.phase = static_cast<int>(r.Get(kPhaseBits));
  s.link_quality = Value(unit_, r.Get(kUnitBits));
  s.saturated = r.Get(kFlagBits) != 0;
  s.has_target = r.Get(kFlagBits) != 0;
  if (!s.has_target) return s;

  s.target = static_cast<int>(r.Get(kTargetBits));
  if (s.target >= targets_) Refuse("target " + std::to_string(s.target) + " does not exist");
  const auto age = static_cast<std::int64_t>(r.Get(kAgeBits));
  s.target_stamp = std::min((generation - age) * kTick, s.generation);
  s.p_WT = GetVector(&r, position_, kPositionBits);
  s.v_WT = GetVector(&r, target_velocity_, kTargetVelocityBits);
  s.target_std = std_of_code_[r.Get(kStdBits)];
  return s;
}

std::array<PacketField, PacketCodec::kFieldCount> PacketCodec::fields() const {
  const auto field = [](const char* name, int bits, const Quantiser& q) {
    return PacketField{name, bits, q.lo, q.hi, q.resolution};
  };
  return {{field("position", kPositionBits, position_), field("velocity", kVelocityBits, velocity_),
           field("confidence", kUnitBits, unit_), field("tracking_error", kErrorBits, error_),
           field("link_quality", kUnitBits, unit_),
           field("target_position", kPositionBits, position_),
           field("target_velocity", kTargetVelocityBits, target_velocity_),
           field("log_target_std", kStdBits, log_std_)}};
}

}  // namespace stg

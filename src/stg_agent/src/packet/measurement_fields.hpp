#pragma once

#include <cstdint>
#include <string>

#include "auv_common/error.hpp"
#include "bits.hpp"
#include "stg_agent/packet/measurement_packet.hpp"

/// Widths of the fields in a packet of measurements. The fields are written and read one after the
/// other.
namespace stg::agent {

inline constexpr std::uint64_t kMeasurementVersion = 2, kFreeVersion = 3, kLocatedVersion = 5;
inline constexpr int kSourceBits = 8, kGenerationBits = 18, kTargetBits = 5, kAgeBits = 10;
inline constexpr int kPlaceBits = 15, kSpeedBits = 8, kUnitBits = 4, kDeviationBits = 6,
                     kErrorBits = 7;
inline constexpr int kOffsetBits = 9, kRiseBits = 7, kRangeBits = 14, kAzimuthBits = 11;
inline constexpr int kElevationBits = 10, kFineAzimuthBits = 14, kFineElevationBits = 12;
inline constexpr int kCrcFirst = 8 * kPacketBytes - 8;
inline constexpr int kFirstSighting = 4 + kSourceBits + kGenerationBits + 3 * kPlaceBits +
                                      3 * kSpeedBits + kDeviationBits + kErrorBits + kUnitBits + 2 +
                                      kUnitBits + 1;
inline constexpr int kSightingBits = 62;
/// With task.assignment free: the target that the sender follows, and that of each measurement, as
/// one more than its index; 0: none.
inline constexpr int kNameBits = 4, kManyBits = 2, kFreeRangeBits = 12, kEarlierBits = 9;
/// With a localizer: ranges, a fix and a bearing replace measurements of targets. Their codes are
/// not indices of targets.
inline constexpr int kLocatedDeviationBits = kDeviationBits - 1;
inline constexpr std::uint64_t kRangesCode = 31, kFixCode = 30, kBearingCode = 29, kNoSource = 31;
inline constexpr int kSentSourceBits = 5, kSentAgeBits = 9, kSentRangeBits = 14,
                     kSentAzimuthBits = 14;
inline constexpr int kSentErrorBits = 21, kSentStdBits = 5;
inline constexpr double kMostError_m = 65535.0, kLeastFixStd_m = 0.1, kMostFixStd_m = 100.0;
inline constexpr int kSurfacingBit = kFirstSighting + kSightings * kSightingBits;
static_assert(1 + kTargetBits + kSentAgeBits + 2 * kSentErrorBits + kSentStdBits == kSightingBits,
              "a fix takes the room of a measurement");
static_assert(kSurfacingBit + 1 == kCrcFirst, "all bits are used");
static_assert(1 + kTargetBits + kSentRanges * (kSentSourceBits + kSentAgeBits + kSentRangeBits) ==
                  kSightingBits,
              "two ranges take the room of a measurement");
static_assert(kFirstSighting + kSightings * kSightingBits <= kCrcFirst, "both measurements fit");

[[noreturn]] inline void RefusePacket(const std::string& why) { throw UserError("packet: " + why); }

/// Writes fields one after the other.
struct MeasurementPacket::Writer {
  Words words{};
  int at = 0;
  bool saturated = false;

  void Bits(std::uint64_t code, int count) {
    Put(&words, {at, count}, code);
    at += count;
  }
  void Number(const Quantiser& q, double value, int count) {
    Bits(Code(q, value, &saturated), count);
  }
  void Vector(const Quantiser& q, const Vec3<double>& v, int count) {
    Number(q, v.x, count);
    Number(q, v.y, count);
    Number(q, v.z, count);
  }
};

struct MeasurementPacket::Reader {
  Words words{};
  int at = 0;
  bool unused_code = false;

  std::uint64_t Bits(int count) {
    const std::uint64_t code = Get(words, {at, count});
    at += count;
    return code;
  }
  double Number(const Quantiser& q, int count) { return Value(q, Bits(count), &unused_code); }
  Vec3<double> Vector(const Quantiser& q, int count) {
    const double x = Number(q, count), y = Number(q, count);
    return {x, y, Number(q, count)};
  }
};

}  // namespace stg::agent

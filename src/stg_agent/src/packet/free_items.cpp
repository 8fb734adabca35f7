#include <algorithm>
#include <stdexcept>
#include <string>

#include "measurement_fields.hpp"
#include "stg_agent/packet/measurement_packet.hpp"

namespace stg::agent {

using dynamics::Detection;
using dynamics::MeasurementKind;

namespace {

constexpr int kFreeFirst = kFirstSighting + kNameBits;
constexpr int kLookBits = kAgeBits + 2 * kOffsetBits + kRiseBits;
constexpr int kItemBits = kNameBits + kFreeRangeBits;
constexpr int kThree = 3;  // ranges of two measurements
static_assert(kFreeFirst + kManyBits + kLookBits + kFreeSightings * kItemBits <= kCrcFirst,
              "one look fits");
static_assert(kFreeFirst + kManyBits + 2 * kLookBits - kAgeBits + kEarlierBits +
                      kThree * kItemBits <=
                  kCrcFirst,
              "two looks fit");
static_assert(kFreeFirst + 2 * (kNameBits + kSightingBits - 1 - kTargetBits) <= kCrcFirst,
              "both measurements fit");

/// Number of sightings from `first` on that have the same time.
int OfOneLook(const NeighbourState& s, int first) {
  int count = 0;
  while (first + count < s.sightings.size() &&
         s.sightings[first + count].stamp == s.sightings[first].stamp) {
    ++count;
  }
  return count;
}

}  // namespace

void MeasurementPacket::WriteName(int target, Writer* w) const {
  w->Bits(static_cast<std::uint64_t>(target + 1), kNameBits);
}

int MeasurementPacket::ReadName(Reader* r) const {
  const int target = static_cast<int>(r->Bits(kNameBits)) - 1;
  if (target >= targets_) RefusePacket("target " + std::to_string(target) + " does not exist");
  return target;
}

void MeasurementPacket::WriteFree(const NeighbourState& s, Writer* w) const {
  WriteName(std::max(s.followed, -1), w);
  if (!s.has_target || s.sightings.empty()) return;
  if (kind_ == MeasurementKind::kRange) {
    WriteLooks(s, w);
    return;
  }
  const int fit = ambiguous_ ? 1 : kSightings;
  for (int k = 0; k < std::min(s.sightings.size(), fit); ++k) {
    const Detection& d = s.sightings[k];
    RequireCode(s, d);
    WriteName(d.target, w);
    WriteMeasured(s, d, w);
  }
}

void MeasurementPacket::WriteLooks(const NeighbourState& s, Writer* w) const {
  const int newest = OfOneLook(s, 0),
            earlier = newest < s.sightings.size() ? OfOneLook(s, newest) : 0;
  const bool two = newest < kThree && earlier > 0;
  w->Bits(two ? static_cast<std::uint64_t>(newest) : 0, kManyBits);
  const auto look = [&](const Detection& d, TimeNs steps, int bits) {
    RequireCode(s, d);
    WriteAge(steps, bits, w);
    WriteObserver(s, d, w);
  };
  const TimeNs age = AgeCode(s, s.sightings[0]);
  look(s.sightings[0], age, kAgeBits);
  if (two) {
    const Detection& second = s.sightings[newest];
    look(second, AgeCode(s, second) - age, kEarlierBits);
  }
  const int count =
      two ? newest + std::min(earlier, kThree - newest) : std::min(newest, kFreeSightings);
  for (int k = 0; k < count; ++k) {
    const Detection& d = s.sightings[k];
    RequireCode(s, d);
    WriteName(d.target, w);
    w->Number(range_, d.range_m, kFreeRangeBits);
  }
}

void MeasurementPacket::ReadFree(Reader* r, NeighbourState* s) const {
  r->at = kFirstSighting;
  s->followed = ReadName(r);
  if (kind_ == MeasurementKind::kRange) {
    ReadLooks(r, s);
    return;
  }
  const int fit = ambiguous_ ? 1 : kSightings;
  for (int k = 0; k < fit; ++k) {
    const int target = ReadName(r);
    if (target < 0) return;
    ReadMeasured(*s, target, r, &s->sightings.push_back({}));
  }
}

void MeasurementPacket::ReadLooks(Reader* r, NeighbourState* s) const {
  const int newest = static_cast<int>(r->Bits(kManyBits));
  if (newest >= kThree) RefusePacket("a field holds an unused code");
  const bool two = newest > 0;
  TimeNs stamp[2];
  Vec3<double> p_WO[2];
  TimeNs steps = static_cast<TimeNs>(r->Bits(kAgeBits));
  for (int look = 0; look < (two ? 2 : 1); ++look) {
    if (look == 1) steps += static_cast<TimeNs>(r->Bits(kEarlierBits));
    stamp[look] = s->generation - steps * age_step_;
    p_WO[look] = ReadObserver(*s, r);
  }
  const int most = two ? kThree : kFreeSightings;
  for (int k = 0; k < most; ++k) {
    const int target = ReadName(r);
    const double range_m = r->Number(range_, kFreeRangeBits);
    if (target < 0) continue;
    const int look = two && k >= newest ? 1 : 0;
    if (stamp[look] < 0) RefusePacket("measured before the start");
    Detection& d = s->sightings.push_back({});
    d.kind = kind_;
    d.target = target;
    d.stamp = stamp[look];
    d.p_WO = d.p_WT = p_WO[look];
    d.range_m = range_m;
    SetDeviations(*s, &d);
  }
}

}  // namespace stg::agent

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "acoustic_channel/water/sound_speed.hpp"
#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"
#include "stg_agent/packet/neighbour_state.hpp"

namespace stg::agent {

/// Mean of 1/c [s/m] over the depths between two positions.
inline double SlownessBetween(const acoustics::SoundSpeedProfile& sound, double surface_z_m,
                              const Vec3<double>& a, const Vec3<double>& b) {
  return sound.MeanSlowness(std::max(0.0, surface_z_m - a.z), std::max(0.0, surface_z_m - b.z));
}

/// The newest range that a member of the network measured of each other member, and the choice of
/// those that go into a packet.
class MeasuredRanges {
 public:
  /// @param members AUVs, then stations
  MeasuredRanges(int auvs, int members) : auvs_(auvs), newest_(static_cast<std::size_t>(members)) {}

  void Clear() { std::fill(newest_.begin(), newest_.end(), SentRange()); }
  void Add(const SentRange& range) { newest_[static_cast<std::size_t>(range.source)] = range; }

  /// Adds to a packet a range to a station, if one was received, and a range to an AUV. The choice
  /// changes from packet to packet.
  void Tell(NeighbourState* packet) const {
    const auto stations = static_cast<int>(newest_.size()) - auvs_;
    const auto draw = static_cast<std::uint64_t>(packet->generation / 1000000);
    Pick(auvs_, stations, draw, packet);
    Pick(0, auvs_, draw, packet);
    if (packet->ranges.size() == 1) Pick(0, auvs_, draw + 1, packet);
  }

 private:
  /// A packet contains no range that is older than this.
  static constexpr TimeNs kOldest = 30'000'000'000;

  bool Usable(int id, const NeighbourState& packet) const {
    const SentRange& r = newest_[static_cast<std::size_t>(id)];
    if (r.range_m == 0.0 || r.range_m < kLeastRange_m || r.range_m > kMostRange_m) return false;
    if (packet.generation - r.stamp > kOldest) return false;
    return packet.ranges.empty() || packet.ranges[0].source != id;
  }

  /// Adds one of the newest ranges of members first .. first + count - 1.
  void Pick(int first, int count, std::uint64_t draw, NeighbourState* packet) const {
    if (packet->ranges.full()) return;
    int heard = 0;
    for (int id = first; id < first + count; ++id) heard += Usable(id, *packet) ? 1 : 0;
    if (heard == 0) return;
    // A hash spreads the choice for any rhythm of the packets.
    const std::uint64_t mixed = (draw * 0x9E3779B97F4A7C15ULL) >> 33;
    auto chosen = static_cast<int>(mixed % static_cast<std::uint64_t>(heard));
    for (int id = first; id < first + count; ++id) {
      if (!Usable(id, *packet) || chosen-- > 0) continue;
      packet->ranges.push_back(newest_[static_cast<std::size_t>(id)]);
      return;
    }
  }

  int auvs_;
  std::vector<SentRange> newest_;  // by member
};

}  // namespace stg::agent

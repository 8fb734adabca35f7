#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "acoustic_channel/modem/packet.hpp"
#include "acoustic_channel/water/sound_speed.hpp"
#include "sent_ways.hpp"
#include "stg_agent/localization/joint_filter.hpp"
#include "stg_agent/localization/measured_ranges.hpp"
#include "stg_agent/localization/own_way.hpp"

namespace stg::agent {

/// Keeps ranges by pings, own ones and those in packets, until the positions of both members at
/// that time are known: those of others after a later packet, the own one at the next decision.
class PingRanges {
 public:
  explicit PingRanges(int self) : self_(self) { waiting_.reserve(kMost); }

  void Clear() { waiting_.clear(); }
  /// Takes an answer to an own ping; an implausible one is dropped.
  /// @param from the direction of the answer; null: it was not measured
  void AddOwn(const acoustics::Reception& answer, const DirectionReading* from) {
    const double way_s = answer.travel_time_s;
    if (!std::isfinite(way_s) || way_s <= 0.0 || waiting_.size() == kMost) return;
    Waiting w;
    w.z.receiver = self_;
    w.z.source = answer.source;
    w.z.at = answer.generation;
    w.travel_time_s = way_s;
    w.has_direction = from != nullptr;
    if (from != nullptr) w.from = *from;
    waiting_.push_back(w);
  }
  /// Takes a range from another member's packet.
  void AddSent(const RangeReading& z) {
    if (waiting_.size() == kMost) return;
    waiting_.emplace_back();
    waiting_.back().z = z;
  }

  /// Calls take(const RangeReading&, const DirectionReading*) for each complete range, with the
  /// direction or null, and drops ranges older than `oldest`.
  /// @param ways of all members
  template <class Take>
  void Give(TimeNs oldest, const OwnWay& own, const std::vector<SentWay>& ways,
            const acoustics::SoundSpeedProfile& sound, double surface_z_m, Take&& take) {
    std::size_t kept = 0;
    for (Waiting& w : waiting_) {
      RangeReading& z = w.z;
      const bool asked = z.receiver == self_, was_asked = z.source == self_;
      if ((asked || was_asked) && !w.placed) {
        w.placed = own.At(z.at, asked ? &z.p_receiver : &z.p_source);
        if (!w.placed) continue;
      }
      const auto way = [&ways](int id) -> const SentWay& {
        return ways[static_cast<std::size_t>(id)];
      };
      const bool here = asked || way(z.receiver).Between(z.at, &z.p_receiver);
      const bool there = was_asked || way(z.source).Between(z.at, &z.p_source);
      if (here && there) {
        if (asked) {
          z.range_m =
              w.travel_time_s / SlownessBetween(sound, surface_z_m, z.p_receiver, z.p_source);
        }
        w.from.source = z.source;
        w.from.at = z.at;
        w.from.p_receiver = z.p_receiver;
        w.from.p_source = z.p_source;
        take(z, w.has_direction ? &w.from : nullptr);
      } else if (z.at >= oldest) {
        waiting_[kept++] = w;
      }
    }
    waiting_.resize(kept);
  }

 private:
  static constexpr std::size_t kMost = 64;
  struct Waiting {
    RangeReading z;
    double travel_time_s = 0.0;  ///< of an own ping
    bool placed = false;         ///< the own position is in z
    bool has_direction = false;
    DirectionReading from;  ///< its direction is known, its positions are those of z
  };

  int self_;
  std::vector<Waiting> waiting_;
};

}  // namespace stg::agent

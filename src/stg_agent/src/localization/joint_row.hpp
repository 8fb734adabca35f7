#pragma once

#include <array>
#include <cstddef>

#include "stg_agent/localization/joint_filter.hpp"

namespace stg::agent {

/// A packet names 31 members. The most states are those of 8 AUVs and 23 beacons with estimated
/// clocks and headings: 7 of each AUV, 4 of each beacon, and 3 of all.
inline constexpr int kMostJointStates = 7 * JointFilter::kMostObservers + 4 * 23 + 3;

inline double Squared(double x) { return x * x; }

/// The nonzero numbers of a row.
struct JointFilter::Row {
  std::array<int, 24> index{};
  std::array<double, 24> value{};
  int count = 0;

  void Add(int i, double v) {
    for (int k = 0; k < count; ++k) {
      if (index[static_cast<std::size_t>(k)] != i) continue;
      value[static_cast<std::size_t>(k)] += v;
      return;
    }
    index[static_cast<std::size_t>(count)] = i;
    value[static_cast<std::size_t>(count++)] = v;
  }
};

}  // namespace stg::agent

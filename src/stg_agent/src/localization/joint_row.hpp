#pragma once

#include <array>
#include <cstddef>

#include "stg_agent/localization/joint_filter.hpp"

namespace stg::agent {

inline constexpr int kMostJointStates = 128;

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

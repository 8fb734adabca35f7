#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "auv_common/step/step_barrier.hpp"

namespace stg::step_barrier_test {

using Opening = StepBarrier::Opening;
using Word = StepBarrier::Word;
using Parties = std::vector<int>;

inline constexpr TimeNs kStep = 100'000'000;
inline constexpr TimeNs kFirst = 1'000'000'000;
inline constexpr double kForever = std::numeric_limits<double>::infinity();

inline void HearAll(StepBarrier* barrier, const Parties& parties) {
  for (const int i : parties) EXPECT_EQ(barrier->Hear(i, barrier->stamp()), Word::kCounts);
}

}  // namespace stg::step_barrier_test

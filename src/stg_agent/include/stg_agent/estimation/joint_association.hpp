#pragma once

#include <array>

#include "auv_dynamics/measurements.hpp"

namespace stg::agent {

/// [detection][target]: how many times likelier a detection of a look is of a target than false; 0:
/// it is not of this target.
using LookOdds = std::array<std::array<double, dynamics::kMostTargets>, dynamics::kMostTargets>;

/// Returns how many times likelier it is that a detection is of another target than that it is
/// false. The case that this target caused another detection of the look is included. With the odds
/// o and the
/// result r, the detection is of its target with the probability o / (o + 1 + r), the marginal
/// probability of joint association: each target causes at most one detection, each detection is of
/// at most one target, and the probability of a joint association is proportional to the product of
/// its odds. Without competition the result is 0.
///
/// Exact if at most kMostExact targets have odds above 0; with more, other detections and targets
/// count as if they had no competition among themselves (Fitzgerald 1986), which makes the result
/// too large.
double RivalsOf(const LookOdds& odds, int detections, int targets, int detection, int target);

inline constexpr int kMostExact = 8;

}  // namespace stg::agent

#pragma once

#include "gaussian_mixture.hpp"
#include "stg_agent/estimation/target_filter.hpp"

namespace stg::agent {

/// Mean and covariance of a mixture over the target's state and, where navigation drifts, the own
/// errors: in the world, and in the frame of the own navigation, which is off by them.
void SetMoments(const GaussianMixture& mixture, bool drifts, TargetBelief* belief,
                TargetEstimate* estimate);

}  // namespace stg::agent

#pragma once

#include "gaussian_mixture.hpp"
#include "stg_agent/estimation/target_filter.hpp"

namespace stg::agent {

/// Computes mean and covariance of a mixture over the target's state and, if navigation drifts, the
/// own errors: in the world, and in the frame of the own navigation, which differs by these errors.
void SetMoments(const GaussianMixture& mixture, bool drifts, TargetBelief* belief,
                TargetEstimate* estimate);

}  // namespace stg::agent

#pragma once

#include "auv_common/numbers/random.hpp"

/// The actor of soft actor-critic (Haarnoja et al. 2018): u ~ N(m, sigma^2) and a = tanh(u). The
/// network's outputs are (m, x) [2 size], and log sigma = lo + (hi - lo) (1 + tanh x) / 2.
namespace stg::learn {

struct LogStdRange {
  float lo = -5.0F, hi = 1.0F;
};

/// log sigma of an output x.
float SquashedLogStd(const LogStdRange& range, float x);

/// Computes the action of a draw. Returns the natural log of its density in [-1, 1]^size.
/// @param outputs [2 size]. @param noise [size], standard normal. @param action [size], written
float SquashedSample(const LogStdRange& range, const float* outputs, const float* noise, int size,
                     float* action);

/// d loss / d outputs [2 size], for a loss that depends on the action and its log density, at fixed
/// noise.
/// @param action result of SquashedSample
void SquashedGradient(const LogStdRange& range, const float* outputs, const float* noise,
                      const float* action, const float* d_action, float d_log_prob, int size,
                      float* d_outputs);

}  // namespace stg::learn

#pragma once

#include "auv_common/numbers/random.hpp"

/// The actor of soft actor-critic (Haarnoja et al. 2018): u ~ N(m, sigma^2), a = tanh(u), of a
/// network's outputs (m, x) [2 size] with log sigma = lo + (hi - lo) (1 + tanh x) / 2.
namespace stg::learn {

struct LogStdRange {
  float lo = -5.0F, hi = 1.0F;
};

/// Standard deviation before the squash that an output x stands for.
float SquashedLogStd(const LogStdRange& range, float x);

/// The action of a draw and the natural log of its density in [-1, 1]^size.
/// @param outputs [2 size]. @param noise [size], standard normal. @param action [size], written
float SquashedSample(const LogStdRange& range, const float* outputs, const float* noise, int size,
                     float* action);

/// d loss / d outputs [2 size] of a loss of action and log density, at fixed noise.
/// @param action of SquashedSample
void SquashedGradient(const LogStdRange& range, const float* outputs, const float* noise,
                      const float* action, const float* d_action, float d_log_prob, int size,
                      float* d_outputs);

}  // namespace stg::learn

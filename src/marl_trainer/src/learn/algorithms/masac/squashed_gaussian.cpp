#include "marl_trainer/learn/algorithms/masac/squashed_gaussian.hpp"

#include <algorithm>
#include <cmath>

#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {
namespace {

/// log(1 - tanh(u)^2), exact also for large |u|.
float LogSlope(float u) {
  constexpr float kLog2 = 0.693147181F;
  const float softplus = std::max(-2.0F * u, 0.0F) + std::log1p(std::exp(-std::abs(2.0F * u)));
  return 2.0F * (kLog2 - u - softplus);
}

}  // namespace

float SquashedLogStd(const LogStdRange& range, float x) {
  return range.lo + 0.5F * (range.hi - range.lo) * (1.0F + std::tanh(x));
}

float SquashedSample(const LogStdRange& range, const float* outputs, const float* noise, int size,
                     float* action) {
  float log_prob = 0.0F;
  for (int a = 0; a < size; ++a) {
    const float log_std = SquashedLogStd(range, outputs[size + a]);
    const float u = outputs[a] + std::exp(log_std) * noise[a];
    action[a] = std::tanh(u);
    log_prob -= 0.5F * noise[a] * noise[a] + log_std + agent::kHalfLogTwoPi + LogSlope(u);
  }
  return log_prob;
}

void SquashedGradient(const LogStdRange& range, const float* outputs, const float* noise,
                      const float* action, const float* d_action, float d_log_prob, int size,
                      float* d_outputs) {
  for (int a = 0; a < size; ++a) {
    const float t = std::tanh(outputs[size + a]);
    const float half = 0.5F * (range.hi - range.lo);
    const float sigma = std::exp(range.lo + half * (1.0F + t));
    const float d_u = d_action[a] * (1.0F - action[a] * action[a]) + d_log_prob * 2.0F * action[a];
    d_outputs[a] = d_u;
    d_outputs[size + a] = (d_u * sigma * noise[a] - d_log_prob) * half * (1.0F - t * t);
  }
}

}  // namespace stg::learn

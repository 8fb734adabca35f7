#include "marl_trainer/learn/buffers/gae.hpp"

namespace stg::learn {

void GeneralisedAdvantages(const float* rewards, const float* values, const std::uint8_t* done,
                           const float* final_values, float bootstrap, int steps, int stride,
                           float gamma, float lambda, float* advantages) {
  float next_value = bootstrap;
  float next_advantage = 0.0F;
  for (int t = steps - 1; t >= 0; --t) {
    const int i = t * stride;
    if (done[i] != 0) {
      next_value = final_values[i];
      next_advantage = 0.0F;
    }
    const float delta = rewards[i] + gamma * next_value - values[i];
    next_advantage = delta + gamma * lambda * next_advantage;
    advantages[i] = next_advantage;
    next_value = values[i];
  }
}

}  // namespace stg::learn

#pragma once

#include <random>
#include <vector>

namespace stg::learn {

/// `count` normal numbers with mean zero and standard deviation `scale`.
inline std::vector<float> Draw(std::size_t count, float scale, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<float> normal;
  std::vector<float> v(count);
  for (float& x : v) x = scale * normal(rng);
  return v;
}

}  // namespace stg::learn

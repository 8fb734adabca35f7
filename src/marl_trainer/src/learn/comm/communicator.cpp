#include "marl_trainer/learn/comm/communicator.hpp"

namespace stg::learn {
Communicator* Alone() {
  static OneRank alone;
  return &alone;
}

void SumInPairs(std::vector<std::vector<float>>* parts, std::size_t count, std::size_t begin,
                std::size_t end) {
  for (std::size_t stride = 1; stride < count; stride *= 2) {
    for (std::size_t left = 0; left + stride < count; left += 2 * stride) {
      float* to = (*parts)[left].data();
      const float* from = (*parts)[left + stride].data();
      for (std::size_t i = begin; i < end; ++i) to[i] += from[i];
    }
  }
}

}  // namespace stg::learn

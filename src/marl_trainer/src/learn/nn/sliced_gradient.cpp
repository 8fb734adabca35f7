#include "marl_trainer/learn/nn/sliced_gradient.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace stg::learn {

SlicedGradient::SlicedGradient(std::size_t parameters, WorkerPool* pool)
    : pool_(pool), parts_(kSlices, std::vector<float>(parameters)), sum_(parameters) {}

void SlicedGradient::ForRanges(std::size_t count,
                               const std::function<void(std::size_t, std::size_t)>& work) const {
  // Waking the workers costs more than a small network's share.
  constexpr std::size_t kSmall = 65536;
  if (count < kSmall) {
    work(0, count);
    return;
  }
  pool_->Run(kSlices, [&](int slice, int) {
    const auto s = static_cast<std::size_t>(slice);
    work(count * s / kSlices, count * (s + 1) / kSlices);
  });
}

void SlicedGradient::Compute(int first, int count, const Part& part) {
  pool_->Run(kSlices, [&](int slice, int worker) {
    std::vector<float>& gradient = parts_[static_cast<std::size_t>(slice)];
    std::fill(gradient.begin(), gradient.end(), 0.0F);
    part(slice, worker, first + count * slice / kSlices, first + count * (slice + 1) / kSlices,
         gradient.data());
  });
  ForRanges(sum_.size(), [&](std::size_t begin, std::size_t end) {
    std::copy(parts_[0].begin() + static_cast<std::ptrdiff_t>(begin),
              parts_[0].begin() + static_cast<std::ptrdiff_t>(end),
              sum_.begin() + static_cast<std::ptrdiff_t>(begin));
    for (int slice = 1; slice < kSlices; ++slice) {
      const float* g = parts_[static_cast<std::size_t>(slice)].data();
      for (std::size_t i = begin; i < end; ++i) sum_[i] += g[i];
    }
  });
}

double SlicedGradient::Apply(const Adam& adam, std::size_t begin, std::size_t end,
                             double learning_rate, double limit, float* parameters) const {
  const double norm = GradientNorm(sum_.data(), begin, end);
  assert(std::isfinite(norm));
  const float shrink = ShrinkTo(limit, norm);
  ForRanges(end - begin, [&](std::size_t from, std::size_t to) {
    adam.Apply(begin + from, begin + to, learning_rate, shrink, sum_.data(), parameters);
  });
  return norm;
}

}  // namespace stg::learn

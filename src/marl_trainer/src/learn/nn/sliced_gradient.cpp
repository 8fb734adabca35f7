#include "marl_trainer/learn/nn/sliced_gradient.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "auv_common/error.hpp"

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

std::vector<int> SlicedGradient::EqualSlices(int first, int count) {
  std::vector<int> bounds(kSlices + 1);
  for (int slice = 0; slice <= kSlices; ++slice) {
    bounds[static_cast<std::size_t>(slice)] = first + count * slice / kSlices;
  }
  return bounds;
}

void SlicedGradient::ComputeEqual(int count, const Part& part) {
  const std::vector<int> bounds = EqualSlices(0, count);
  if (ranks_ == nullptr) {
    Compute(bounds, part);
    return;
  }
  const GroupShare share = GroupShare::Of(*ranks_, kSlices);
  assert(share.groups == kSlices);
  const auto first = bounds.begin() + share.first;
  Compute({first, first + share.count + 1},
          [&](int slice, int worker, int begin, int end, float* gradient) {
            part(share.first + slice, worker, begin, end, gradient);
          });
}

void SlicedGradient::Compute(const std::vector<int>& bounds, const Part& part) {
  const std::size_t slices = bounds.size() - 1;
  assert(slices <= parts_.size());
  pool_->Run(static_cast<int>(slices), [&](int slice, int worker) {
    const auto s = static_cast<std::size_t>(slice);
    std::vector<float>& gradient = parts_[s];
    std::fill(gradient.begin(), gradient.end(), 0.0F);
    part(slice, worker, bounds[s], bounds[s + 1], gradient.data());
  });
  ForRanges(sum_.size(), [&](std::size_t begin, std::size_t end) {
    if (ranks_ != nullptr) SumInPairs(&parts_, slices, begin, end);
    std::copy(parts_[0].begin() + static_cast<std::ptrdiff_t>(begin),
              parts_[0].begin() + static_cast<std::ptrdiff_t>(end),
              sum_.begin() + static_cast<std::ptrdiff_t>(begin));
    if (ranks_ != nullptr) return;
    for (std::size_t slice = 1; slice < slices; ++slice) {
      const float* g = parts_[slice].data();
      for (std::size_t i = begin; i < end; ++i) sum_[i] += g[i];
    }
  });
  if (ranks_ != nullptr) ranks_->Sum(sum_.data(), sum_.size());
}

double SlicedGradient::Apply(const Adam& adam, std::size_t begin, std::size_t end,
                             double learning_rate, double limit, float* parameters) const {
  const double norm = GradientNorm(sum_.data(), begin, end);
  if (!std::isfinite(norm)) {
    throw UserError("the training diverged: a gradient is not finite (smaller learning rates?)");
  }
  const float shrink = ShrinkTo(limit, norm);
  ForRanges(end - begin, [&](std::size_t from, std::size_t to) {
    adam.Apply(begin + from, begin + to, learning_rate, shrink, sum_.data(), parameters);
  });
  return norm;
}

}  // namespace stg::learn

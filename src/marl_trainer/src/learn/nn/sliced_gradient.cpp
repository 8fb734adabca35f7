#include "marl_trainer/learn/nn/sliced_gradient.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "auv_common/error.hpp"

namespace stg::learn {

SlicedGradient::SlicedGradient(std::size_t parameters, const Team& team)
    : team_(team),
      parts_(static_cast<std::size_t>(team.share().count), std::vector<float>(parameters)),
      sum_(parameters) {}

void SlicedGradient::ForRanges(std::size_t count,
                               const std::function<void(std::size_t, std::size_t)>& work) const {
  // For a small network, waking the workers costs more time than it saves.
  constexpr std::size_t kSmall = 65536, kRanges = 16;
  if (count < kSmall) {
    work(0, count);
    return;
  }
  team_.pool->Run(kRanges, [&](int range, int) {
    const auto r = static_cast<std::size_t>(range);
    work(count * r / kRanges, count * (r + 1) / kRanges);
  });
}

void SlicedGradient::ComputeEqual(int count, const Part& part) {
  const GroupShare share = team_.share();
  assert(share.groups == kGroups);
  std::vector<int> bounds;
  for (int slice = share.first; slice <= share.first + share.count; ++slice) {
    bounds.push_back(count * slice / kGroups);
  }
  Compute(bounds, [&](int slice, int worker, int begin, int end, float* gradient) {
    part(share.first + slice, worker, begin, end, gradient);
  });
}

void SlicedGradient::Compute(const std::vector<int>& bounds, const Part& part) {
  assert(bounds.size() == parts_.size() + 1);
  team_.pool->Run(static_cast<int>(parts_.size()), [&](int slice, int worker) {
    const auto s = static_cast<std::size_t>(slice);
    std::vector<float>& gradient = parts_[s];
    std::fill(gradient.begin(), gradient.end(), 0.0F);
    part(slice, worker, bounds[s], bounds[s + 1], gradient.data());
  });
  ForRanges(sum_.size(), [&](std::size_t begin, std::size_t end) {
    SumInPairs(&parts_, parts_.size(), begin, end);
    std::copy(parts_[0].begin() + static_cast<std::ptrdiff_t>(begin),
              parts_[0].begin() + static_cast<std::ptrdiff_t>(end),
              sum_.begin() + static_cast<std::ptrdiff_t>(begin));
  });
  team_.ranks->Sum(sum_.data(), sum_.size());
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

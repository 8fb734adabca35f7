#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "marl_trainer/learn/comm/team.hpp"
#include "marl_trainer/learn/nn/adam.hpp"

namespace stg::learn {

/// The gradient of a minibatch, computed by all workers of all ranks: the samples are cut into a
/// slice for each group, which has a gradient of its own. They are summed in pairs, so that the
/// result depends neither on the number of workers nor on that of ranks.
class SlicedGradient {
 public:
  /// Adds the gradient of samples begin .. end-1 to `gradient` [parameters], which is zero.
  using Part = std::function<void(int slice, int worker, int begin, int end, float* gradient)>;

  SlicedGradient(std::size_t parameters, const Team& team);

  /// Runs `part` for every slice of this rank, samples bounds[s] .. bounds[s + 1] - 1, then sums
  /// over all ranks.
  /// @param bounds one more than this rank's groups
  void Compute(const std::vector<int>& bounds, const Part& part);
  /// The same of the samples 0 .. count-1 that all ranks have, in kGroups equal slices, of which
  /// every rank computes its share; `slice` counts those of all. For up to kGroups ranks.
  void ComputeEqual(int count, const Part& part);

  /// Runs `work` on ranges that cover 0 .. count-1, on all workers where that pays.
  void ForRanges(std::size_t count,
                 const std::function<void(std::size_t, std::size_t)>& work) const;

  /// One step of Adam on parameters[begin, end) with its gradient clipped to norm `limit`; `adam`
  /// has moved on to this step. Returns the norm before clipping. UserError, and the parameters as
  /// they were, where it is not finite: the training diverged. All ranks have the same sum, and
  /// throw together.
  double Apply(const Adam& adam, std::size_t begin, std::size_t end, double learning_rate,
               double limit, float* parameters) const;

  /// Of the last Compute.
  const std::vector<float>& sum() const { return sum_; }

 private:
  const Team team_;
  std::vector<std::vector<float>> parts_;  // [this rank's groups][parameters]
  std::vector<float> sum_;
};

}  // namespace stg::learn

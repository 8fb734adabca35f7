#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "marl_trainer/learn/comm/team.hpp"
#include "marl_trainer/learn/nn/adam.hpp"

namespace stg::learn {

/// The gradient of a minibatch, computed by all workers of all ranks. The samples are divided into
/// one slice for each group, and each group has its own gradient. The gradients are summed in
/// pairs, so the result depends neither on the number of workers nor on the number of ranks.
class SlicedGradient {
 public:
  /// Adds the gradient of samples begin .. end-1 to `gradient` [parameters], which is zero at
  /// first.
  using Part = std::function<void(int slice, int worker, int begin, int end, float* gradient)>;

  SlicedGradient(std::size_t parameters, const Team& team);

  /// Runs `part` for every slice s of this rank, on samples bounds[s] .. bounds[s + 1] - 1. Then
  /// sums over all ranks.
  /// @param bounds one number more than this rank has groups
  void Compute(const std::vector<int>& bounds, const Part& part);
  /// The same for samples 0 .. count-1 that all ranks have, in kGroups equal slices. Every rank
  /// computes its share of the slices; `slice` counts the slices of all ranks. For up to kGroups
  /// ranks.
  void ComputeEqual(int count, const Part& part);

  /// Runs `work` on ranges that cover 0 .. count-1, on all workers if this saves time.
  void ForRanges(std::size_t count,
                 const std::function<void(std::size_t, std::size_t)>& work) const;

  /// Makes one step of Adam on parameters[begin, end), with its gradient clipped to norm `limit`.
  /// `adam` must have begun this step. Returns the norm before clipping. If the norm is not finite,
  /// the training has diverged: throws UserError and leaves the parameters unchanged. All ranks
  /// have the same sum, so all of them throw.
  double Apply(const Adam& adam, std::size_t begin, std::size_t end, double learning_rate,
               double limit, float* parameters) const;

  /// Sum of the last Compute.
  const std::vector<float>& sum() const { return sum_; }

 private:
  const Team team_;
  std::vector<std::vector<float>> parts_;  // [this rank's groups][parameters]
  std::vector<float> sum_;
};

}  // namespace stg::learn

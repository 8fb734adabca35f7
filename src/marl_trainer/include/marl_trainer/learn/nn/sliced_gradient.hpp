#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/learn/comm/communicator.hpp"
#include "marl_trainer/learn/nn/adam.hpp"

namespace stg::learn {

/// The gradient of a minibatch, computed by all workers: the samples are cut into kSlices fixed
/// slices with a gradient each, which are summed in order, so that the result does not depend on
/// the number of workers. Among several ranks, a slice is a group of environments and a rank has
/// the slices of its own; they are summed in pairs, so that the result does not depend on the
/// number of ranks either.
class SlicedGradient {
 public:
  static constexpr int kSlices = 16;

  /// Adds the gradient of samples begin .. end-1 to `gradient` [parameters], which is zero.
  using Part = std::function<void(int slice, int worker, int begin, int end, float* gradient)>;

  /// @param pool must outlive this object.
  SlicedGradient(std::size_t parameters, WorkerPool* pool);

  /// @param ranks must outlive this object.
  void Join(Communicator* ranks) { ranks_ = ranks; }

  /// Runs `part` for every slice, samples bounds[s] .. bounds[s + 1] - 1, then sums, over all
  /// ranks.
  /// @param bounds of up to kSlices slices, one more than slices
  void Compute(const std::vector<int>& bounds, const Part& part);
  /// The same of the samples 0 .. count-1 in kSlices equal slices, of which every rank has its
  /// share: of up to kSlices ranks.
  void ComputeEqual(int count, const Part& part);
  static std::vector<int> EqualSlices(int first, int count);

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
  WorkerPool* pool_;
  Communicator* ranks_ = nullptr;
  std::vector<std::vector<float>> parts_;  // [kSlices][parameters]
  std::vector<float> sum_;
};

}  // namespace stg::learn

#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/learn/algorithms/on_policy/ppo_loss.hpp"
#include "marl_trainer/learn/algorithms/on_policy/ppo_samples.hpp"
#include "marl_trainer/learn/nn/sliced_gradient.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {

/// What one update did.
struct PpoReport {
  PpoSums sums;                                ///< of the last epoch
  double actor_norm = 0.0, critic_norm = 0.0;  ///< mean gradient norms before clipping
  int epochs = 0;
  int samples = 0;     ///< of all ranks
  double flops = 0.0;  ///< floating-point operations in matrix products, of all ranks
};

/// Sums of an epoch, in an order that depends neither on workers nor on ranks.
class SlicedSums {
 public:
  /// @param ranks must outlive this object.
  void Join(Communicator* ranks) { ranks_ = ranks; }
  /// Of a slice of the minibatch; whoever computes it writes it.
  PpoSums& slice(int s) { return minibatch_[static_cast<std::size_t>(s)]; }
  void EndMinibatch();
  /// Sums of all minibatches of all ranks; the next epoch begins.
  PpoSums EndEpoch();

 private:
  using Slices = std::array<PpoSums, SlicedGradient::kSlices>;

  Slices minibatch_, epoch_;
  PpoSums total_;
  Communicator* ranks_ = nullptr;
};

/// What all methods of this family report, in the order of the columns.
/// @param sigma, entropy of the exploration, the mean over actors
std::vector<ReportColumn> PpoColumns();
std::vector<double> PpoValues(const PpoReport& report, double learning_rate, double entropy,
                              double explained_variance, double sigma);

/// Epochs of minibatch gradient steps over one collection.
class PpoUpdate {
 public:
  /// @param networks, pool must outlive this object.
  PpoUpdate(const ActorCritic& networks, const PpoOptions& config, const TrainConfig& common,
            int agents, WorkerPool* pool);
  ~PpoUpdate();

  /// As Algorithm::Join.
  void Join(Communicator* ranks);

  /// The number of samples must be a multiple of the minibatch.
  /// @param collection number of the update, for the order of the minibatches.
  /// @param learning_rate_scale multiplies both learning rates.
  /// @param imitation share of the teacher in the actor's loss, see PpoBatch.
  PpoReport Run(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales,
                std::uint32_t collection, double learning_rate_scale, double imitation,
                std::vector<float>* parameters, AdamState* adam);

 private:
  struct Scratch;                    // per worker
  static constexpr int kBlock = 64;  // environment steps per pass through the networks

  PpoSums Slice(const float* parameters, int begin, int end, int worker, float* gradient);
  void Step(double learning_rate_scale, std::vector<float>* parameters, AdamState* adam,
            PpoReport* report);

  const ActorCritic& networks_;
  const PpoOptions config_;
  const std::uint64_t seed_;
  const int agents_;
  SlicedGradient gradient_;
  std::vector<std::unique_ptr<Scratch>> scratch_;
  SlicedSums sums_;
  PpoSamples samples_;
  float imitation_ = 0.0F;
};

}  // namespace stg::learn

#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/learn/buffers/rollout.hpp"
#include "marl_trainer/learn/nn/actor_critic.hpp"

namespace stg::learn {

/// Sums over rows of what an update reports.
struct PpoSums {
  double actor_loss = 0.0, value_loss = 0.0, kl = 0.0, clipped = 0.0;
  double imitation_error = 0.0;  ///< squared distance to the teacher's action
  double rows = 0.0, samples = 0.0;
  void Add(const PpoSums& other);
};

/// Minibatch rows, gathered; [count] environment steps of `agents` rows each.
struct PpoBatch {
  int count = 0, agents = 0;
  const float* observations = nullptr;  ///< [count, agents, F]
  const float* actions = nullptr;       ///< [count, agents, A]
  const float* log_prob = nullptr;      ///< [count, agents]
  const float* teacher = nullptr;       ///< [count, agents, A]; read where imitation > 0
  const float* states = nullptr;        ///< [count, S]
  const float* advantages = nullptr;    ///< [count], normalised
  const float* targets = nullptr;       ///< [count], normalised value targets
  /// In [0, 1]: share of the actor's loss that is, instead of Eq. 41, half the squared miss of
  /// the teacher's action a, in sigmas, over (1 + |a / sigma|^2)^(f/2), f = imitation_focus.
  /// Sigma is not fitted to it.
  float imitation = 0.0F;
};

/// Loss of Eqs. 41-44 and its gradient, on one worker's scratch memory.
class PpoLoss {
 public:
  PpoLoss(const ActorCritic& networks, const TrainConfig& config, int max_samples, int agents);

  /// Adds the gradient of the loss to gradient [parameters]. Every term is
  /// weighted as one of `minibatch` environment steps.
  PpoSums AddGradient(const float* parameters, const PpoBatch& batch, int minibatch,
                      float* gradient);

 private:
  void AddActor(const float* parameters, const PpoBatch& batch, int minibatch, float* gradient,
                PpoSums* sums);
  void AddCritic(const float* parameters, const PpoBatch& batch, int minibatch, float* gradient,
                 PpoSums* sums);

  const ActorCritic& networks_;
  const float clip_, focus_, entropy_, value_weight_;
  Mlp::Workspace actor_, critic_;
  std::vector<float> d_actor_, d_critic_;
};

/// Adam's state; moments [parameters].
struct AdamState {
  std::vector<float> first, second;
  std::int64_t steps = 0;
};

/// What one update did.
struct UpdateReport {
  PpoSums sums;                                ///< of the last epoch
  double actor_norm = 0.0, critic_norm = 0.0;  ///< mean gradient norms before clipping
  int epochs = 0;
  double flops = 0.0;  ///< floating-point operations in matrix products
};

/// Epochs of minibatch gradient steps over one collection. The minibatch is cut
/// into kSlices fixed slices with a gradient each, summed in order: the result
/// does not depend on the number of workers.
class PpoUpdate {
 public:
  static constexpr int kSlices = 16;

  PpoUpdate(const ActorCritic& networks, const TrainConfig& config, int agents, WorkerPool* pool);
  ~PpoUpdate();

  /// @param learning_rate_scale multiplies both learning rates.
  UpdateReport Run(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales,
                   std::uint32_t collection, double learning_rate_scale,
                   std::vector<float>* parameters, AdamState* adam, double imitation = 0.0);

 private:
  struct Scratch;                    // per worker
  static constexpr int kBlock = 64;  // environment steps per pass through the networks

  void Prepare(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales);
  void Shuffle(std::uint32_t collection, int epoch);
  void Slice(const std::vector<const RolloutBuffer*>& rollouts, const float* parameters, int first,
             int slice, int worker);
  void ForRanges(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work);
  void Step(double learning_rate_scale, std::vector<float>* parameters, AdamState* adam,
            UpdateReport* report);

  const ActorCritic& networks_;
  const TrainConfig config_;
  const int agents_;
  WorkerPool* pool_;
  std::vector<std::unique_ptr<Scratch>> scratch_;
  std::vector<std::vector<float>> gradients_;  // [kSlices][parameters]
  std::array<PpoSums, kSlices> sums_;
  std::vector<float> gradient_;
  std::vector<int> order_, rollout_of_, index_of_;
  float imitation_ = 0.0F;
  std::vector<float> advantages_, targets_;  // normalised, by sample
};

}  // namespace stg::learn

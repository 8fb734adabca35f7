#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "marl_trainer/learn/algorithms/happo/happo_config.hpp"
#include "marl_trainer/learn/algorithms/on_policy/ppo_rows.hpp"
#include "marl_trainer/learn/algorithms/on_policy/ppo_update.hpp"

namespace stg::learn {

/// What HAPPO trains: an actor for each AUV, with its log sigma, and one critic.
struct HappoParameters {
  std::vector<std::vector<float>> actors;  ///< [agents][actor parameters]
  std::vector<AdamState> actor_adams;
  std::vector<float> critic;
  AdamState critic_adam;
};

/// One HAPPO iteration (Kuba et al. 2022): the AUVs' actors learn one after the other in a fresh
/// random order, each on the advantage times M, the joint probability ratio of those before it;
/// then the critic learns once.
class HappoUpdate {
 public:
  /// @param networks shapes of one actor and the critic. networks, pool must outlive this object.
  HappoUpdate(const ActorCritic& networks, const HappoConfig& config, const TrainConfig& common,
              int agents, WorkerPool* pool);
  ~HappoUpdate();

  void Join(Communicator* ranks);

  /// As PpoUpdate::Run.
  PpoReport Run(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales,
                std::uint32_t collection, double learning_rate_scale, double imitation,
                HappoParameters* parameters);

  /// The factors M of the samples after the last AUV of the last Run: the ratio of the joint
  /// densities, new over old, of the actions taken. In the order of the own rollouts.
  const std::vector<double>& factors() const { return factors_; }
  /// Mean |M - 1| over the samples of all ranks.
  double ratio_miss() const { return ratio_miss_; }
  /// The AUVs in the order of the last Run.
  const std::vector<int>& order() const { return order_; }

 private:
  struct Scratch;                     // per worker
  static constexpr int kBlock = 256;  // samples per pass through the networks

  void DrawOrder(std::uint32_t collection);
  int TrainActor(int agent, std::uint32_t turn, std::vector<float>* actor, AdamState* adam,
                 PpoReport* report);
  void TrainCritic(std::vector<float>* critic, AdamState* adam, PpoReport* report);
  /// Fills a batch with what the loss needs of the samples at these places.
  PpoBatch Gather(int from, int to, int agent, PpoRows* rows);
  /// Adds the gradient of one block's loss.
  using BlockLoss =
      std::function<void(PpoLoss* loss, const PpoBatch& batch, float* gradient, PpoSums* sums)>;
  /// The gradient of the minibatch that begins at sample `first`.
  void ComputeGradient(int first, int agent, const BlockLoss& add, SlicedGradient* gradient);
  /// Multiplies the factors by the ratio of an AUV's densities.
  void MultiplyFactors(const std::vector<const RolloutBuffer*>& rollouts, int agent,
                       const float* actor);
  double RatioMiss(const std::vector<const RolloutBuffer*>& rollouts) const;

  const ActorCritic& networks_;
  const HappoConfig config_;
  const std::uint64_t seed_;
  const int agents_;
  WorkerPool* pool_;
  Communicator* ranks_ = nullptr;
  SlicedGradient actor_gradient_, critic_gradient_;
  std::vector<std::unique_ptr<Scratch>> scratch_;
  SlicedSums sums_;
  PpoSamples samples_;
  std::vector<double> factors_;  // by sample
  double ratio_miss_ = 0.0;
  std::vector<int> order_;
  // Of the run.
  std::uint32_t collection_ = 0;
  double learning_rate_scale_ = 1.0;
  float imitation_ = 0.0F;
};

}  // namespace stg::learn

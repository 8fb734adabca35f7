#pragma once

#include <string>
#include <utility>
#include <vector>

#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/learn/checkpoint/archive.hpp"
#include "marl_trainer/learn/nn/adam.hpp"
#include "marl_trainer/learn/swarm/network/entity_actor.hpp"
#include "marl_trainer/learn/swarm/swarm_shard.hpp"

namespace stg::learn {

/// MAPPO over entities: the clipped update of Eqs. 37-44 with one actor for all AUVs. Each AUV has
/// its own value and advantage, instead of one for the swarm. Returns are normalised by PopArt (van
/// Hasselt et al. 2016). Results do not depend on the number of workers.
class SwarmLearner {
 public:
  explicit SwarmLearner(const SwarmConfig& config);

  SwarmActor actor() const {
    return {actor_, actor_numbers_.data(), actor_numbers_.data() + actor_.parameters()};
  }
  /// Learns from one collection. @param progress done share of the training, in [0, 1]
  /// @param imitation share of imitation in the loss of the actor; above 0 the rollouts are taught
  /// Returns its results, by name.
  using Report = std::vector<std::pair<std::string, double>>;
  /// kCritic: the actor stays as it is, and the critic learns at the rate of an untrained one.
  enum class Learns { kBoth, kCritic };
  Report Update(std::vector<SwarmRollout>* rollouts, std::uint32_t collection, double progress,
                WorkerPool* pool, Learns learns = Learns::kBoth, double imitation = 0.0);

  /// The policy as it is, and its mean over the last updates (SwarmConfig::average).
  agent::EntityPolicy Policy(const agent::PolicyMetadata& metadata) const;
  agent::EntityPolicy AveragePolicy(const agent::PolicyMetadata& metadata) const;
  void Save(Archive* archive) const;
  /// Throws UserError for an archive with other sizes.
  void Load(const Archive& archive);
  /// Takes the actor and its exploration from a policy with the same network and action. The critic
  /// stays untrained.
  void StartFrom(const agent::EntityPolicy& policy);
  /// Sets the log standard deviation of the exploration.
  void SetDeviation(double log_std);
  /// Throws UserError if the actor uses an input that it may not see. @param start where it is from
  void RequireBlind(const std::string& start) const;

 private:
  static constexpr int kSlices = 8;
  struct Row {
    int rollout, row;
  };
  struct Part {
    PackedRows actor_rows, critic_rows;
    ActorWorkspace actor;
    PoolBatch::Workspace critic;
    std::vector<float> d_critic, actor_gradient, critic_gradient, log_shares;
    double kl = 0.0, clipped = 0.0, value_loss = 0.0, entropy = 0.0, imitation_error = 0.0;
  };

  void Evaluate(SwarmRollout* rollout, Part* part) const;
  void Advantages(SwarmRollout* rollout, const std::vector<float>& finals,
                  const std::vector<float>& next) const;
  void Normalise(const std::vector<SwarmRollout>& rollouts);
  agent::EntityPolicy PolicyOf(const std::vector<float>& numbers,
                               const agent::PolicyMetadata& metadata) const;
  void Gradient(const std::vector<SwarmRollout>& rollouts, const std::vector<Row>& rows,
                std::size_t begin, std::size_t end, std::size_t batch, double entropy,
                Part* part) const;
  /// Adds the gradient of the loss of a row to the gradient of the actor's outputs.
  void ActorLoss(const SwarmRollout& rollout, std::size_t row, int at, double entropy, float share,
                 Part* part) const;
  void Imitate(const float* taught, const float* mean, float share, float* d_mean,
               Part* part) const;
  void KeepBlind(std::vector<float>* numbers) const;

  SwarmConfig config_;
  int size_;
  EntityActor actor_;
  PoolBatch critic_;
  std::vector<bool> blind_;  // parameters of the actor that stay at 0, or empty
  // The actor's numbers include its log deviations.
  std::vector<float> actor_numbers_, critic_numbers_;
  std::vector<float> average_;  // of actor_numbers_
  double averaged_ = 0.0;       // number of updates in average_
  AdamState actor_adam_, critic_adam_;
  double mean_ = 0.0, square_ = 1.0, seen_ = 0.0;  // moments of the returns
  double std_ = 1.0;
  double imitation_ = 0.0;       // share of imitation in the present update
  bool without_critic_ = false;  // a trained actor has an untrained critic
  float advantage_mean_ = 0.0F, advantage_scale_ = 1.0F;
  std::vector<Part> parts_;
};

}  // namespace stg::learn

#pragma once

#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/actor_critic.hpp"

namespace stg::learn {

/// Sums over rows, for the report of an update.
struct PpoSums {
  double actor_loss = 0.0, value_loss = 0.0, kl = 0.0, clipped = 0.0;
  double imitation_error = 0.0;  ///< squared distance to the teacher's action
  double rows = 0.0, samples = 0.0;
  void Add(const PpoSums& other);
};

/// Gathered rows of a minibatch: [count] environment steps of `agents` rows each. The critic's loss
/// reads only states and targets, and the actor's loss reads all the others.
struct PpoBatch {
  int count = 0, agents = 0;
  const float* observations = nullptr;  ///< [count, agents, F]
  const float* actions = nullptr;       ///< [count, agents, A]
  const float* log_prob = nullptr;      ///< [count, agents]
  const float* teacher = nullptr;       ///< [count, agents, A]; only read if imitation > 0
  const float* states = nullptr;        ///< [count, S]
  const float* advantages = nullptr;    ///< [count], normalised
  const float* targets = nullptr;       ///< [count], normalised value targets
  /// Share of the actor's loss that is imitation, in [0, 1]. The imitation loss replaces Eq. 41 by
  /// half the squared distance to the teacher's action a, in sigmas, over (1 + |a / sigma|^2)^(f/2)
  /// with f = imitation_focus. Sigma gets no gradient of it.
  float imitation = 0.0F;
};

/// Loss of Eqs. 41-44 and its gradient, with the scratch memory of one worker.
class PpoLoss {
 public:
  /// @param networks must outlive this object. @param max_rows largest number of rows of a batch
  PpoLoss(const ActorCritic& networks, const PpoOptions& config, int max_rows);

  /// Adds the gradient of the actor's loss (Eqs. 41, 42), including log sigma, to gradient
  /// [parameters]. Each term has the weight of one of `minibatch` environment steps.
  void AddActor(const float* actor, const PpoBatch& batch, int minibatch, float* gradient,
                PpoSums* sums);
  /// The same for the critic (Eq. 43).
  void AddCritic(const float* critic, const PpoBatch& batch, int minibatch, float* gradient,
                 PpoSums* sums);

 private:
  const ActorCritic& networks_;
  const float clip_, focus_, entropy_, value_weight_;
  Mlp::Workspace actor_, critic_;
  std::vector<float> d_actor_, d_critic_;
  std::vector<float> z_, inverse_std_;  // [A]
  std::vector<double> d_sigma_;         // [A]
};

}  // namespace stg::learn

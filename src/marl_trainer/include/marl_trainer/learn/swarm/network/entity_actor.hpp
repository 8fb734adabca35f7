#pragma once

#include <string>
#include <variant>
#include <vector>

#include "marl_trainer/learn/swarm/network/graph_batch.hpp"
#include "marl_trainer/learn/swarm/network/pool_batch.hpp"
#include "stg_agent/entities/entity_policy.hpp"

namespace stg::learn {

/// What an actor over entities says of many AUVs: of each what there is to choose from, with its
/// logit, and the mean of the command if that is chosen. A network that does not choose has one
/// choice for each AUV.
struct ActorWorkspace {
  PoolBatch::Workspace pool;
  GraphBatch::Workspace graph;
  std::vector<int> first;                ///< [rows + 1], the first choice of an AUV
  std::vector<float> logits, means;      ///< [choices], [choices, size]
  std::vector<float> d_logits, d_means;  ///< of the loss, for Backward; means before tanh
};

/// The actor's network, whichever it is, for many AUVs at once.
class EntityActor {
 public:
  /// @param outputs numbers of a command
  EntityActor(agent::EntityNetwork network, int outputs);

  std::size_t parameters() const;
  int outputs() const { return outputs_; }
  bool chooses() const { return std::holds_alternative<GraphBatch>(network_); }
  void Initialise(std::uint64_t seed, std::uint32_t network, float* parameters) const;

  /// Fills first, logits and means, and clears d_logits and d_means.
  void Forward(const float* parameters, const PackedRows& x, ActorWorkspace* w) const;
  /// Adds to the gradient what d_logits and d_means of the last Forward say.
  void Backward(const float* parameters, const PackedRows& x, ActorWorkspace* w,
                float* gradient) const;

 private:
  int outputs_;
  std::variant<PoolBatch, GraphBatch> network_;
};

/// Logarithm of the probability of each choice of AUV `row`; returns how many there are.
int LogShares(const ActorWorkspace& w, int row, std::vector<float>* log_shares);

/// Parameters that an ablation keeps at 0, so that the network cannot see something. The policy
/// file needs no word of it: it flies as it was trained.
///
/// @param without `neighbours` (the rows of neighbours and edges; the six numbers of Eq. 18 stay),
///   `graph` (these six numbers, phases and qualities too), `edges`, `age`, `covariance`, `links`
///   (link quality), `search` or `nothing`; another name throws UserError
std::vector<bool> Blinded(agent::EntityNetwork network, int outputs, const std::string& without);
/// The names that Blinded takes; `nothing` is the first.
std::vector<std::string> BlindNames();

}  // namespace stg::learn

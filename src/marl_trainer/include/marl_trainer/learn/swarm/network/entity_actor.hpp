#pragma once

#include <string>
#include <variant>
#include <vector>

#include "marl_trainer/learn/swarm/network/graph_batch.hpp"
#include "marl_trainer/learn/swarm/network/pool_batch.hpp"
#include "stg_agent/entities/entity_policy.hpp"

namespace stg::learn {

/// Output of an actor over entities for many AUVs. For each AUV it has the choices, the logit of
/// each, and the mean of the command that belongs to it. A network that does not choose has one
/// choice for each AUV.
struct ActorWorkspace {
  PoolBatch::Workspace pool;
  GraphBatch::Workspace graph;
  std::vector<int> first;            ///< [rows + 1], first choice of each AUV
  std::vector<float> logits, means;  ///< [choices], [choices, size]
  /// Gradient of the loss, for Backward. For the means it is the gradient before tanh.
  std::vector<float> d_logits, d_means;
};

/// The actor's network of either kind, for many AUVs at once.
class EntityActor {
 public:
  /// @param outputs size of a command
  EntityActor(agent::EntityNetwork network, int outputs);

  std::size_t parameters() const;
  int outputs() const { return outputs_; }
  bool chooses() const { return std::holds_alternative<GraphBatch>(network_); }
  void Initialise(std::uint64_t seed, std::uint32_t network, float* parameters) const;

  /// Computes first, logits and means, and sets d_logits and d_means to zero.
  void Forward(const float* parameters, const PackedRows& x, ActorWorkspace* w) const;
  /// Adds the gradient that follows from d_logits and d_means, for the last Forward.
  void Backward(const float* parameters, const PackedRows& x, ActorWorkspace* w,
                float* gradient) const;

 private:
  int outputs_;
  std::variant<PoolBatch, GraphBatch> network_;
};

/// Computes the logarithm of the probability of each choice of AUV `row`. Returns the number of
/// choices.
int LogShares(const ActorWorkspace& w, int row, std::vector<float>* log_shares);

/// Parameters that an ablation keeps at 0, so that the network cannot use a part of its input. The
/// policy file does not mention the ablation, because it flies as it was trained.
///
/// @param without `neighbours` (the rows of neighbours and edges; the six numbers of Eq. 18 stay),
///   `graph` (these six numbers, phases and qualities, too), `edges`, `age`, `covariance`, `links`
///   (link quality), `search` or `nothing`; another name throws UserError
/// @param last_command false: the network cannot use the AUV's last command either
std::vector<bool> Blinded(agent::EntityNetwork network, int outputs, const std::string& without,
                          bool last_command);
/// Names that Blinded accepts; `nothing` is the first.
std::vector<std::string> BlindNames();

}  // namespace stg::learn

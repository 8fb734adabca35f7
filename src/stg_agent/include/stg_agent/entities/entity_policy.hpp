#pragma once

#include <string>
#include <variant>
#include <vector>

#include "stg_agent/entities/entities.hpp"
#include "stg_agent/entities/graph_network.hpp"
#include "stg_agent/entities/pool_network.hpp"
#include "stg_agent/policy/policy.hpp"

namespace stg::agent {

/// Meaning of the numbers in a command (docs/entities.md). The policy file names it.
enum class EntityAction {
  kGuidance,  ///< five: guidance of the law `encircle`; all zero: the law without changes
  kLaw5,      ///< five: the same for the law that fits the situation
  kCourse3,   ///< three: change of course, speed and climb; no law
  kVelocity3  ///< three: velocity in K, for one decision; between walls; no law
};
inline constexpr int CommandSize(EntityAction action) {
  return action == EntityAction::kCourse3 || action == EntityAction::kVelocity3 ? 3 : 5;
}
/// "guidance", "law5", "course3" and "velocity3", in their order.
const std::vector<std::string>& EntityActionNames();
std::string EntityActionName(EntityAction action);
/// Throws UserError for another name.
EntityAction EntityActionNamed(const std::string& name);

/// Throws UserError for an action that AUVs of this scenario cannot fly: velocity3 needs walls, the
/// others need open water.
void RequireFits(EntityAction action, const AgentModel& model);

/// The networks of an actor over entities, named in the policy file.
enum class EntityNetwork {
  kPool,  ///< PoolNetwork, which reads no edges and follows the target that it follows
  kGraph  ///< GraphNetwork, which chooses a target to follow, or to search
};
/// "pool" and "graph", in their order.
const std::vector<std::string>& EntityNetworkNames();
std::string EntityNetworkName(EntityNetwork network);
/// Throws UserError for another name.
EntityNetwork EntityNetworkNamed(const std::string& name);

/// Their sizes. @param outputs CommandSize
PoolSpec EntityActorSpec(int outputs);
GraphSpec EntityGraphSpec(int outputs);
/// Numbers of such a network. @param outputs CommandSize
std::size_t EntityParameters(EntityNetwork network, int outputs);
/// The rows that such a network takes, in its order: targets, neighbours, obstacles.
inline constexpr int kEntitySets = 3;
void EntityRows(const Entities& entities, PoolRows (*sets)[kEntitySets]);
GraphRows EntityGraphRows(const Entities& entities);

/// A policy over entities: one file for any number of AUVs. command = tanh(network). Immutable.
class EntityPolicy {
 public:
  struct Parameters {
    std::vector<float> numbers;  ///< [EntityParameters]
    EntityAction action = EntityAction::kGuidance;
    EntityNetwork network = EntityNetwork::kPool;
    std::vector<float> log_std;  ///< [CommandSize], for exploration; not used by Command
    double noise_time_s = 0.0;   ///< correlation time of the exploration; 0: independent commands
    PolicyMetadata metadata;     ///< layout and interface are set by the constructor
  };
  static constexpr std::int64_t kMaxFileBytes = 16LL << 20;
  static constexpr double kMaxNoiseTime_s = 1e4;

  /// Throws UserError when shapes disagree or a number is not finite.
  explicit EntityPolicy(Parameters parameters);

  /// Whether a file says that it is one; false for what cannot be read.
  static bool IsOne(const std::string& path);
  /// Reads a file that SaveOnnx wrote, and no other graph; throws UserError that names the file.
  static EntityPolicy LoadOnnx(const std::string& path);
  /// Inputs `self` [1, 26], `search` [1, 28], `targets` [T, 40], `neighbours` [N, 22], `obstacles`
  /// [O, 10]; output `command` [1, n]. Of `graph` also the input `edges` [T, N, 8], and the outputs
  /// `commands` [T + 1, n] and `choices` [1, T + 1], the largest of which counts.
  void SaveOnnx(const std::string& path) const;

  /// The logit and the command of every choice: of each target, then to search. `pool` has one
  /// choice, whose logit is 0.
  /// @param logits [kTargetRows + 1], commands [kTargetRows + 1, CommandSize], in [-1, 1]
  /// Returns the number of choices.
  int Choices(const Entities& entities, float* logits, float* commands) const;
  /// The command of the largest logit.
  /// @param command [CommandSize], in [-1, 1]
  /// Returns the row of the target that is chosen, or their number: to search. Of `pool` always 0.
  int Command(const Entities& entities, float* command) const;

  /// Throws UserError when its action does not fit the scenario.
  void RequireFits(const AgentModel& model) const;

  /// Whether it chooses a target or to search.
  bool chooses() const { return parameters_.network == EntityNetwork::kGraph; }
  EntityAction action() const { return parameters_.action; }
  const Parameters& parameters() const { return parameters_; }
  const PolicyMetadata& metadata() const { return parameters_.metadata; }

 private:
  Parameters parameters_;
  std::variant<PoolNetwork, GraphNetwork> network_;
};

}  // namespace stg::agent

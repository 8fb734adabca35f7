#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "stg_agent/controllers/controller.hpp"
#include "stg_agent/entities/entity_draw.hpp"
#include "stg_agent/policy/policy.hpp"

namespace stg::agent {

/// Decides for the AUVs of a swarm, in nodes, environments and Python. It holds exactly one of: a
/// policy or one policy for each AUV, a policy over entities, a built-in controller.
struct Decider {
  std::string name;                                     ///< as the user gave it
  std::vector<std::shared_ptr<const Policy>> policies;  ///< one for all AUVs, or one for each AUV
  std::shared_ptr<const EntityPolicy> entities;         ///< acoustic mode only
  std::shared_ptr<const Controller> builtin;
  bool privileged = false;  ///< a built-in controller reads true states, if available

  /// True: it decides from the observation; false: from all that the agent knows.
  bool observes() const { return !policies.empty(); }
  /// The mean action of AUV `id`'s policy. @param observation [observation_size]
  void Act(int id, const float* observation, float* action) const;
  /// The action of the controller or of the policy over entities.
  void Act(const AgentView& agent, float* action) const;

  /// Replaces the mean by a sample of the policy's Gaussian, a function of (seed, step, id) only;
  /// returns its natural log density. Built-in controllers do not explore: returns 0 and keeps the
  /// mean.
  /// @param seed seed of the episode; the same seed gives the same samples in any episode
  float Explore(std::uint64_t seed, std::uint32_t step, int id, float* action) const;

  /// The action of the policy over entities that explores. The random numbers are a function of
  /// (seed, number of the command, id) only; correlated noise also depends on the AUV's noise
  /// before. Returns true if the AUV has a new command. Only with `entities`.
  /// @param decision the new command, otherwise unchanged
  bool Explore(std::uint64_t seed, std::uint32_t step, const AgentView& agent,
               EntityDecision* decision, float* action) const;

  /// The controller's name, or the identity in the policy file of AUV `id`.
  const std::string& IdOf(int id) const;
  /// The policy file of AUV `id`; empty for a built-in controller.
  std::string FileOf(int id) const;
  const Policy& PolicyOf(int id) const;
};

/// The Decider of a built-in controller (see MakeController), of an ONNX file, or of one file for
/// each AUV (see PolicyFileOf). Reads only the files of AUVs first .. end - 1. Throws UserError.
Decider ReadDecider(const std::string& name_or_file, int first, int end);

/// The same for a whole swarm, whose policies must fit the model. Throws UserError.
Decider MakeDecider(const std::string& name_or_file, const AgentModel& model);

}  // namespace stg::agent

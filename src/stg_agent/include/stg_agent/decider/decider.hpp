#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "stg_agent/controllers/controller.hpp"
#include "stg_agent/entities/entity_policy.hpp"
#include "stg_agent/policy/policy.hpp"

namespace stg::agent {

/// What decides for the AUVs of a swarm, in nodes, environments and Python alike: a policy, or one
/// for each AUV, a policy on entities, or a built-in controller. Exactly one of the three is there.
struct Decider {
  std::string name;                                     ///< as the user gave it
  std::vector<std::shared_ptr<const Policy>> policies;  ///< one for all AUVs, or one for each
  std::shared_ptr<const EntityPolicy> entities;         ///< acoustic mode only
  std::shared_ptr<const Controller> builtin;
  bool privileged = false;  ///< a built-in controller reads true states where there are any

  /// It decides on the observation, else on all that the agent knows.
  bool observes() const { return !policies.empty(); }
  /// The mean action of AUV `id`'s policy. @param observation [observation_size]
  void Act(int id, const float* observation, float* action) const;
  /// What the controller or the policy on entities does.
  void Act(const AgentView& agent, float* action) const;

  /// Replaces the mean by a sample of the policy's Gaussian, a function of (seed, step, id) only;
  /// returns its natural log density. Others have no spread: returns 0 and leaves the mean.
  /// @param seed that of the episode: the same seed gives the same episode, whatever its number
  float Explore(std::uint64_t seed, std::uint32_t step, int id, float* action) const;

  /// What AUV `id` flies: the controller's name, or the identity that the policy file states.
  const std::string& IdOf(int id) const;
  /// Where that was read from; empty for a built-in controller.
  std::string FileOf(int id) const;
  const Policy& PolicyOf(int id) const;
};

/// The Decider of a built-in controller (see MakeController), of an ONNX file, or of one file for
/// each AUV (see PolicyFileOf). Reads only the files of AUVs first .. end - 1. Throws UserError.
Decider ReadDecider(const std::string& name_or_file, int first, int end);

/// The same for a whole swarm, whose policies must fit the model. Throws UserError.
Decider MakeDecider(const std::string& name_or_file, const AgentModel& model);

}  // namespace stg::agent

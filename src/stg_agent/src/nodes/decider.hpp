#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "stg_agent/agent/agent.hpp"
#include "stg_agent/controllers/controller.hpp"
#include "stg_agent/entities/entity_policy.hpp"
#include "stg_agent/policy/policy.hpp"

namespace stg::nodes {

/// What turns an observation into an action: a policy file or a built-in controller.
class Decider {
 public:
  /// @param name a built-in controller, an ONNX file (see agent::PolicyFileOf), or "auto": the
  ///             policy shipped for the scenario's name where there is one, else pursuit_separated
  /// @param agent who decides
  /// Throws UserError when the file is not a policy for this scenario.
  Decider(const std::string& name, const agent::AgentModel& model, int agent);

  /// The policy's mean action, or the built-in controller's.
  void Mean(const agent::Agent& agent, const float* observation, float* action) const;

  /// Replaces the mean by a sample of the policy's Gaussian, a function of (seed, step, agent)
  /// only; returns its natural log density. A built-in controller has no spread: returns 0 and
  /// leaves the mean.
  /// @param seed that of the episode: the same seed gives the same episode, whatever its number
  float Explore(std::uint64_t seed, std::uint32_t step, int agent, float* action) const;

  const std::string& id() const { return id_; }
  /// Where the policy was read from; empty for a built-in controller.
  const std::string& file() const { return file_; }

 private:
  std::string id_, file_;
  std::unique_ptr<const agent::Policy> policy_;  // null: one of the following
  std::unique_ptr<const agent::EntityPolicy> entities_;
  std::shared_ptr<const agent::Controller> builtin_;
};

}  // namespace stg::nodes

#pragma once

#include <string>

#include "stg_agent/decider/decider.hpp"

namespace stg::nodes {

/// The Decider of one agent node.
/// @param name a built-in controller, an ONNX file (see agent::PolicyFileOf), or "auto": the
/// shipped policy for the scenario's name if there is one, otherwise pursuit_separated
/// Throws UserError when the file is not a policy for this scenario.
agent::Decider DeciderFor(const std::string& name, const agent::AgentModel& model, int id);

/// The parameter `explore`: the agent draws its actions at random. Throws UserError if the decider
/// cannot do this and does not wait for a policy either.
bool ExploreParameter(const agent::Decider& decider, int id);

}  // namespace stg::nodes

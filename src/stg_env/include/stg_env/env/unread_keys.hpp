#pragma once

#include <string>
#include <vector>

#include "stg_agent/decider/decider.hpp"
#include "stg_env/scenario/scenario.hpp"

/// Overrides that have no effect because of what decides: a law, a policy over entities, or a
/// policy over the observation read different numbers. What a scenario alone leaves unread is
/// refused when it is loaded (config::Owner).
namespace stg::env {

/// The part of a scenario that decides what is read.
struct Chosen {
  agent::AgentModel model;
  InformationMode mode;
  task::RewardKind reward;
};

/// Throws UserError for an override "KEY=value" that this decider does not read.
/// A controller that somebody else registered may read anything.
void RefuseUnread(const agent::Decider& decider, const Chosen& chosen,
                  const std::vector<std::string>& overrides);

/// The same for a policy over the observation that is trained.
/// @param teacher the controller that the policy imitates, with its constants if needed; may be
/// empty. What it reads has an effect, too.
void RefuseUnreadInTraining(const std::string& teacher, const Chosen& chosen,
                            const std::vector<std::string>& overrides);

}  // namespace stg::env

#pragma once

#include "stg_agent/agent_config.hpp"
#include "stg_agent/localization/localizer.hpp"

/// Factories of the built-in localizers.
namespace stg::agent {

std::unique_ptr<Localizer> MakeRangeLocalizer(const AgentModel& model, const int& self);

}  // namespace stg::agent

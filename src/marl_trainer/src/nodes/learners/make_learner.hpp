#pragma once

#include <memory>

#include "online_learner.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::nodes {

/// The learner that the node's parameters ask for. Throws UserError.
/// @param live false: it must read bags
std::unique_ptr<OnlineLearner> MakeLearner(const Scenario& scenario, bool live);

}  // namespace stg::nodes

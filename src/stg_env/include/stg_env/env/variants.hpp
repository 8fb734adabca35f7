#pragma once

#include <string>

#include "stg_env/scenario/scenario.hpp"

namespace stg::env {

/// The scenario a variant of Table S9 trains in:
/// - stg: unchanged;
/// - semantic: observation without the graph block, raw reward;
/// - velocity3: raw observation, raw reward;
/// - tau6: raw observation, force interface (scale 0.18, no smoothing or rate
///   limit), raw reward.
/// The raw reward is the release's for its baselines. Returns of trainings with
/// different rewards do not compare, so validation and evaluation always use the
/// unchanged scenario's reward (ValidationScenario).
Scenario VariantScenario(const Scenario& scenario, const std::string& variant);
/// VariantScenario with the reward of `scenario`, in the scenario's own stage.
Scenario ValidationScenario(const Scenario& scenario, const std::string& variant);

}  // namespace stg::env

#pragma once

#include <string>

#include "stg_env/scenario/scenario.hpp"

namespace stg::env {

/// The scenario in which a variant of Table S9 trains:
/// - stg: unchanged;
/// - semantic: observation without the graph block, raw reward;
/// - velocity3: raw observation, raw reward;
/// - tau6: raw observation, force interface (scale 0.18, no smoothing or rate
///   limit), raw reward.
/// The raw reward is the reward of the release's baselines. A training keeps the checkpoint with
/// the highest return of its own reward. Returns of different rewards cannot be compared, so a
/// comparison of variants uses the reward of the unchanged scenario (EvaluationScenario).
Scenario VariantScenario(const Scenario& scenario, const std::string& variant);
/// VariantScenario with the reward of `scenario`.
Scenario EvaluationScenario(const Scenario& scenario, const std::string& variant);

}  // namespace stg::env

#pragma once

#include <string>
#include <vector>

#include "stg_env/scenario/scenario.hpp"

namespace stg::env {

/// The variants of Table S9:
/// - stg: the scenario, unchanged;
/// - semantic: observation without the graph block, raw reward;
/// - velocity3: raw observation, raw reward;
/// - tau6: raw observation, force interface (scale 0.18, no smoothing or rate
///   limit), raw reward.
/// The raw reward is the reward of the release's baselines. A training keeps the checkpoint with
/// the highest return of its own reward. Returns of different rewards cannot be compared, so a
/// comparison of variants uses the reward of the unchanged scenario (EvaluationScenario).
enum class Variant { kStg, kSemantic, kVelocity3, kTau6 };

/// The names above, in this order, as the option --variant takes them.
const std::vector<std::string>& VariantNames();
const std::string& NameOf(Variant variant);

/// The keys of a scenario that a variant sets.
enum class VariantKeys { kAll, kWithoutReward };
/// Throws UserError for an override "key.path=value" of a key that the variant sets itself, because
/// the override would have no effect.
void RefuseKeysOf(Variant variant, VariantKeys keys, const std::vector<std::string>& overrides);

/// The scenario in which a variant trains.
Scenario VariantScenario(const Scenario& scenario, Variant variant);
/// Throws UserError for an override "KEY=value" that has no effect in this scenario of a variant.
void RefuseUnreadBy(Variant variant, const Scenario& of_variant,
                    const std::vector<std::string>& overrides);
/// VariantScenario with the reward of `scenario`.
Scenario EvaluationScenario(const Scenario& scenario, Variant variant);

}  // namespace stg::env

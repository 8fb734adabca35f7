#include "stg_env/env/variants.hpp"

#include "auv_common/error.hpp"

namespace stg::env {

Scenario VariantScenario(const Scenario& scenario, const std::string& variant) {
  Scenario s = scenario;
  if (variant == "stg") return s;
  s.agent.observation.graph = false;
  s.reward.kind = task::RewardKind::kReleaseRaw;
  task::RewardWeights raw;
  raw.tracking = 0.55;
  raw.observation = 0.20;
  raw.coordination = 0.10;
  raw.communication = 0.05;
  raw.semantic = 0.0;
  raw.control_cost = 0.08;
  raw.separation = scenario.reward.weights.separation;
  s.reward.weights = raw;
  if (variant == "semantic") return s;
  s.agent.observation.tracking = false;
  s.agent.observation.semantic = false;
  if (variant == "velocity3") return s;
  if (variant != "tau6") {
    throw UserError("--variant: '" + variant + "' is not stg, semantic, velocity3 or tau6");
  }
  s.world.control.interface = dynamics::ActionInterface::kTau6;
  s.world.control.action_scale = 0.18;
  s.world.control.smoothing = 0.0;
  s.world.control.max_delta = 0.0;
  return s;
}

Scenario EvaluationScenario(const Scenario& scenario, const std::string& variant) {
  Scenario s = VariantScenario(scenario, variant);
  s.reward = scenario.reward;
  return s;
}

}  // namespace stg::env

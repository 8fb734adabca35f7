#include "stg_env/env/variants.hpp"

#include <cassert>

#include "auv_common/config/value.hpp"
#include "auv_common/error.hpp"

namespace stg::env {
namespace {

struct Setting {
  const char *key, *value;
};

/// The keys that a variant sets, with their values.
std::vector<Setting> SettingsOf(Variant variant) {
  std::vector<Setting> all;
  if (variant == Variant::kStg) return all;
  all = {{"observation.graph", "false"},          {"reward.kind", "release_raw"},
         {"reward.weights.tracking", "0.55"},     {"reward.weights.observation", "0.20"},
         {"reward.weights.coordination", "0.10"}, {"reward.weights.communication", "0.05"},
         {"reward.weights.semantic", "0.0"},      {"reward.weights.control_cost", "0.08"}};
  if (variant == Variant::kSemantic) return all;
  all.insert(all.end(), {{"observation.tracking", "false"}, {"observation.semantic", "false"}});
  if (variant == Variant::kVelocity3) return all;
  all.insert(all.end(), {{"control.interface", "tau6"},
                         {"control.action_scale", "0.18"},
                         {"control.smoothing", "0.0"},
                         {"control.max_delta", "0.0"}});
  return all;
}

}  // namespace

const std::vector<std::string>& VariantNames() {
  static const std::vector<std::string> names = {"stg", "semantic", "velocity3", "tau6"};
  return names;
}

const std::string& NameOf(Variant variant) {
  return VariantNames().at(static_cast<std::size_t>(variant));
}

void RefuseKeysOf(Variant variant, VariantKeys keys, const std::vector<std::string>& overrides) {
  for (const auto& [key, value] : SettingsOf(variant)) {
    const std::string own = std::string(key) + "=", reward = "reward.";
    if (keys == VariantKeys::kWithoutReward && own.rfind(reward, 0) == 0) continue;
    for (const std::string& text : overrides) {
      if (text.rfind(own, 0) != 0) continue;
      throw UserError("--set '" + text + "': the variant " + NameOf(variant) + " sets " + own +
                      value + "; leave out this override, or choose the variant stg");
    }
  }
}

Scenario VariantScenario(const Scenario& scenario, Variant variant) {
  Scenario s = scenario;
  config::Table table;
  Describe(&s, &table);
  for (const auto& [key, value] : SettingsOf(variant)) {
    const auto message = config::ParseText(*table.Find(key), value);
    assert(!message);
    (void)message;
  }
  return s;
}

void RefuseUnreadBy(Variant variant, const Scenario& of_variant,
                    const std::vector<std::string>& overrides) {
  Scenario s = of_variant;  // a table refers to values that it may change
  config::Table table;
  Describe(&s, &table);
  for (const std::string& text : overrides) {
    const config::Field* field = table.Find(text.substr(0, text.find('=')));
    const config::Owner* owner = field != nullptr ? field->Unchosen() : nullptr;
    if (owner == nullptr) continue;
    throw UserError("--set '" + text + "': " + field->path + ": " +
                    owner->WhyUnread("the variant " + NameOf(variant)));
  }
}

Scenario EvaluationScenario(const Scenario& scenario, Variant variant) {
  Scenario s = VariantScenario(scenario, variant);
  s.reward = scenario.reward;
  return s;
}

}  // namespace stg::env

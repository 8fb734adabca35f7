#include "marl_trainer/learn/algorithms/matd3/matd3_config.hpp"

#include <string>
#include <vector>

namespace stg::learn {

Matd3Config::Matd3Config() {
  critics = 2;
  policy_delay = 2;
  target_noise = 0.05;
}

void Matd3Config::ApplyPreset(const std::string& preset, TrainConfig* common) {
  MaddpgConfig::ApplyPreset(preset, common);
  if (preset == "paper") target_noise = 0.2;
}

void Matd3Config::Describe(config::Table* t) {
  MaddpgConfig::Describe(t);
  t->Add("policy-delay", &policy_delay, {1, 1000}, "-",
         "number of critic updates for each update of the actor and the target networks");
  t->Add("target-noise", &target_noise, {0, 10}, "-",
         "noise of the target policy's actions, as a share of the action's scale");
  t->Add("target-noise-clip", &target_noise_clip, {0, 10}, "-", "its bound");
  t->Own("target-noise-clip", {"target noise", {"on"}, "target-noise", [this] {
                                 return std::vector<std::string>{target_noise > 0.0 ? "on" : "off"};
                               }});
}

}  // namespace stg::learn

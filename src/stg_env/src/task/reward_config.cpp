#include "stg_env/task/reward_config.hpp"

#include <string>
#include <vector>

#include "stg_env/task/judge_config.hpp"
#include "stg_env/task/reward_term.hpp"

namespace stg::task {

using config::Enum;
using config::kNone;
using config::NonNegative;
using config::Positive;

void Describe(RewardConfig* c, config::Table* t) {
  t->Section("reward");
  t->Add("kind", config::Enum(&c->kind, {"paper", "release", "release_raw"}), config::kNone, "-",
         "paper: Eqs. 28-36; release: the release's reward; release_raw: that of the release's raw "
         "baselines");
  t->Section("reward.weights");
  RewardWeights* w = &c->weights;
  t->Add("tracking", &w->tracking, config::NonNegative(1e3), "-", "weight of the tracking term");
  t->Add("observation", &w->observation, config::NonNegative(1e3), "-",
         "weight of the observation term");
  t->Add("coordination", &w->coordination, config::NonNegative(1e3), "-",
         "weight of the coordination term");
  t->Add("communication", &w->communication, config::NonNegative(1e3), "-",
         "weight of the communication term");
  t->Add("semantic", &w->semantic, config::NonNegative(1e3), "-", "weight of the semantic term");
  t->Add("control_cost", &w->control_cost, config::NonNegative(1e3), "-",
         "weight of the control cost, which is subtracted");
  t->Add("separation", &w->separation, config::NonNegative(1e3), "-",
         "weight of the penalty for closeness to another AUV; 0 in the paper");
  t->Section("reward");
  t->Add("band_m", &c->band_m, config::Positive(1e4), "m", "[d_l, d_u]: tracking band");
  t->Add("error_max_m", &c->error_max_m, config::Positive(1e5), "m",
         "e_max: an error of this size or more earns nothing");
  t->Add("w_band", &c->w_band, config::NonNegative(1e3), "-", "Eq. 30: weight of the band term");
  t->Add("w_progress", &c->w_progress, config::NonNegative(1e3), "-", "Eq. 30: weight of progress");
  t->Add("w_closing", &c->w_closing, config::NonNegative(1e3), "-",
         "Eq. 30: weight of closing speed");
  t->Add("w_reacquire", &c->w_reacquire, config::NonNegative(1e3), "-",
         "Eq. 30: weight of reacquisition");
  t->Add("w_too_close", &c->w_too_close, config::NonNegative(1e3), "-",
         "Eq. 30: weight of the penalty inside d_l");
  t->Add("separation_distance_m", &c->separation_distance_m, config::Positive(1e4), "m",
         "the separation penalty is 0 where two AUVs are farther apart than this");
  t->Add("total_limit", &c->total_limit, config::Positive(1e6), "-",
         "an agent's total reward is clipped to +- this value");
  const config::Owner eq30{"reward", {"paper", "release"}, "reward.kind", [c] {
                             const char* const kinds[] = {"paper", "release", "release_raw"};
                             return std::vector<std::string>{kinds[static_cast<int>(c->kind)]};
                           }};
  for (const char* key : {"w_band", "w_progress", "w_closing", "w_reacquire", "w_too_close"}) {
    t->Own(std::string("reward.") + key, eq30);
  }
  t->Own("reward.separation_distance_m",
         {"separation penalty", {"on"}, "reward.weights.separation", [c] {
            return std::vector<std::string>{c->weights.separation > 0.0 ? "on" : "off"};
          }});
  for (const std::string& name : RewardTermsByName().Names()) {
    const std::string section = "reward.terms." + name;
    t->Moved(section, section + ".weight");
    t->Section(section);
    double* weight = &c->terms[name];
    t->AddOptional("weight", weight, "0.0", config::NonNegative(1e3), "-",
                   "weight of this registered term; 0: it is not evaluated");
    RewardTermsByName().DescribeIn(
        section, name, section + ".weight",
        [c] {
          std::vector<std::string> chosen;
          for (const auto& [term, w] : c->terms) {
            if (w > 0.0) chosen.push_back(term);
          }
          return chosen;
        },
        &c->term_options, t);
  }
}

std::optional<config::Violation> FindConflict(const JudgeConfig& s) {
  if (s.agent.task.lost_distance_m <= s.reward.band_m.hi) {
    return config::Violation{{"task.lost_distance_m", "reward.band_m"},
                             "a target inside the tracking band would count as lost"};
  }
  if (s.reward.weights.separation > 0.0 &&
      s.reward.separation_distance_m <= 2.0 * s.world.vehicle.radius_m) {
    return config::Violation{{"reward.separation_distance_m", "vehicle.radius_m"},
                             "the penalty must set in before contact, at two radii"};
  }
  return {};
}

}  // namespace stg::task

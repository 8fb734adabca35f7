#include "auv_dynamics/targets/target_config.hpp"

#include "auv_common/names.hpp"
#include "auv_dynamics/targets/target_motion.hpp"

namespace stg::dynamics {

using config::kNone;
using config::NonNegative;
using config::Positive;
using config::Within;

void Describe(TargetConfig* c, config::Table* t) {
  t->Section("target");
  t->Add("count", &c->count, config::Within(1, 16), "-",
         "number of targets; AUV i is tasked with target i modulo this");
  t->Add("motion", config::Name(&c->motion, TargetMotions().Names()), config::kNone, "-",
         "motion of the targets");
  t->Add("max_speed_mps", &c->max_speed_mps, config::Positive(10), "m/s",
         "largest speed of a target");
  t->Add("max_turn_rate_radps", &c->max_turn_rate_radps, config::Positive(10), "rad/s",
         "largest turn rate of a target, except at walls");
  const auto chosen = [c] { return std::vector<std::string>{c->motion}; };
  t->Own("target.max_turn_rate_radps",
         {"target motion", Without(TargetMotions().Names(), {"constant_velocity"}), "target.motion",
          chosen});
  TargetMotions().Describe("target", "target.motion", chosen, &c->motions, t);
  t->Moved("target.turn_rate_radps", "target.coordinated_turn.rate_radps");
  t->Moved("target.turn_period_s", "target.coordinated_turn.period_s");
  t->Moved("target.waypoint_radius_m", "target.random_waypoint.radius_m");
  t->Moved("target.evasion_range_m", "target.evasive.range_m");
}

}  // namespace stg::dynamics

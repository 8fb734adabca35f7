#include "auv_dynamics/targets/target_config.hpp"

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
  t->Add("max_speed_mps", &c->max_speed_mps, config::Positive(10), "m/s", "no target is faster");
  t->Add("max_turn_rate_radps", &c->max_turn_rate_radps, config::Positive(10), "rad/s",
         "no target turns faster, walls apart");
  t->Add("turn_rate_radps", &c->turn_rate_radps, config::NonNegative(10), "rad/s",
         "coordinated_turn: mean magnitude of the turn rate");
  t->Add("turn_period_s", &c->turn_period_s, config::Positive(1e5), "s",
         "coordinated_turn: time between new turn rates");
  t->Add("waypoint_radius_m", &c->waypoint_radius_m, config::Positive(1e4), "m",
         "random_waypoint: distance at which a waypoint counts as reached");
  t->Add("evasion_range_m", &c->evasion_range_m, config::NonNegative(1e4), "m",
         "evasive: the target flees AUVs closer than this");
}

}  // namespace stg::dynamics

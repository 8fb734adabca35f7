#include "auv_dynamics/autopilot/autopilot_config.hpp"

namespace stg::dynamics {

using config::NonNegative;
using config::Positive;
using config::Within;

void Describe(AutopilotConfig* c, config::Table* t) {
  t->Section("control.autopilot");
  t->AddOptional("period_steps", &c->period_steps, "1", Within(1, 1000), "physics steps",
                 "autopilot: time between two commands to the actuators; a decision is a whole "
                 "number of these periods");
  t->AddOptional(
      "min_speed_mps", &c->min_speed_mps, "0.8", NonNegative(100), "m/s",
      "torpedo, kinematic: smallest commanded speed through the water, as fins need flow");
  t->AddOptional("speed_integral_ps", &c->speed_integral_ps, "0.1", NonNegative(100), "1/s",
                 "torpedo: integral gain of the speed error");
  t->AddOptional("course_gain_ps", &c->course_gain_ps, "0.25", NonNegative(100), "1/s",
                 "torpedo, kinematic: turn rate per course error");
  t->AddOptional("max_turn_rate_radps", &c->max_turn_rate_radps, "0.0873", Positive(100), "rad/s",
                 "torpedo, kinematic: largest commanded turn rate");
  t->AddOptional("turn_gain_ps", &c->turn_gain_ps, "2.5", NonNegative(100), "1/s",
                 "torpedo: angular acceleration per error of turn rate");
  t->AddOptional("turn_integral_ps2", &c->turn_integral_ps2, "0.6", NonNegative(100), "1/s^2",
                 "torpedo: angular acceleration per integral of the error of turn rate");
  t->AddOptional("max_pitch_rad", &c->max_pitch_rad, "0.45", Positive(1.5), "rad",
                 "torpedo: largest commanded pitch");
  t->AddOptional("climb_integral_ps", &c->climb_integral_ps, "0.1", NonNegative(100), "1/s",
                 "torpedo: pitch per integral of (error of climb rate / speed)");
  t->AddOptional("pitch_frequency_radps", &c->pitch_frequency_radps, "1.2", NonNegative(100),
                 "rad/s", "torpedo: frequency of the pitch loop, which is critically damped");
  t->AddOptional("pitch_integral_ps3", &c->pitch_integral_ps3, "0.3", NonNegative(100), "1/s^3",
                 "torpedo: angular acceleration per integral of the error of pitch");
}

}  // namespace stg::dynamics

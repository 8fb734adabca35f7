#include "auv_dynamics/navigation/navigation_config.hpp"

#include "auv_dynamics/navigation/navigation_system.hpp"

namespace stg::dynamics {

using config::kNone;
using config::NonNegative;
using config::Positive;

void Describe(NavigationConfig* c, config::Table* t) {
  t->Section("navigation");
  t->AddOptional("kind", config::Name(&c->kind, NavigationSystems().Names()), "perfect", kNone, "-",
                 "what an AUV knows of its own motion: the truth, or dead reckoning that drifts");
  t->AddOptional(
      "period_s", &c->period_s, "1.0", Positive(3600), "s",
      "dead_reckoning: time between two pings of the Doppler log, rounded to whole physics steps");
  t->AddOptional("dvl_scale_std", &c->dvl_scale_std, "0.002", config::kFraction, "-",
                 "standard deviation of the Doppler log's scale error, drawn per episode");
  t->AddOptional("dvl_noise_mps", &c->dvl_noise_mps, "0.01", NonNegative(10), "m/s",
                 "noise of each horizontal component of a ping");
  t->AddOptional("dvl_altitude_m", &c->dvl_altitude_m, "100.0", NonNegative(12000), "m",
                 "higher above the bottom the log measures velocity through the water");
  t->AddOptional("heading_std_deg", &c->heading_std_deg, "0.3", NonNegative(45), "deg",
                 "standard deviation of the heading's constant error, drawn per episode");
  t->AddOptional("gyro_walk_deg_per_sqrt_h", &c->gyro_walk_deg_per_sqrt_h, "0.1", NonNegative(60),
                 "deg/sqrt(h)", "random walk of the heading");
  t->AddOptional("depth_std_m", &c->depth_std_m, "0.05", NonNegative(100), "m",
                 "noise of the depth from pressure");
  t->AddOptional("gps_depth_m", &c->gps_depth_m, "0.3", NonNegative(100), "m",
                 "shallower than this every ping comes with a fix; 0: never");
  t->AddOptional("gps_std_m", &c->gps_std_m, "3.0", Positive(1e4), "m, world ENU",
                 "standard deviation of each horizontal component of a fix");
  t->AddOptional("start_std_m", &c->start_std_m, "1.0", NonNegative(1e4), "m, world ENU",
                 "standard deviation of each horizontal component at the start of an episode");
  t->AddOptional("current_std_mps", &c->current_std_mps, "0.1", NonNegative(10), "m/s, world ENU",
                 "current that the stated deviation reckons with while the log has no bottom");
}

}  // namespace stg::dynamics

#include "auv_dynamics/navigation/navigation_config.hpp"

#include "auv_dynamics/navigation/navigation_system.hpp"

namespace stg::dynamics {

using config::kNone;
using config::NonNegative;
using config::Positive;

namespace {

void DescribeDeadReckoning(NavigationConfig* c, config::Table* t) {
  t->Add("period_s", &c->period_s, Positive(3600), "s",
         "time between two pings of the Doppler log, rounded to whole physics steps");
  t->Add("dvl_scale_std", &c->dvl_scale_std, config::kFraction, "-",
         "standard deviation of the Doppler log's scale error, drawn per episode");
  t->Add("dvl_noise_mps", &c->dvl_noise_mps, NonNegative(10), "m/s",
         "noise of each horizontal component of a ping");
  t->Add("dvl_altitude_m", &c->dvl_altitude_m, NonNegative(12000), "m",
         "above this altitude the Doppler log does not reach the bottom and measures velocity "
         "through the water");
  t->Add("heading_std_deg", &c->heading_std_deg, NonNegative(45), "deg",
         "standard deviation of the heading's constant error, drawn per episode");
  t->Add("gyro_walk_deg_per_sqrt_h", &c->gyro_walk_deg_per_sqrt_h, NonNegative(60), "deg/sqrt(h)",
         "random walk of the heading");
  t->Add("depth_std_m", &c->depth_std_m, NonNegative(100), "m", "noise of the depth from pressure");
  t->Add("gps_depth_m", &c->gps_depth_m, NonNegative(100), "m",
         "above this depth GPS gives a position (a fix); 0: never");
  t->Add("gps_std_m", &c->gps_std_m, Positive(1e4), "m, world ENU",
         "standard deviation of each horizontal component of a GPS position");
  t->AddOptional(
      "fixes", config::Enum(&c->fixes, {"correct", "reported"}), "correct", kNone, "-",
      "use of GPS fixes: each ping at the surface has a fix, which corrects the reckoned "
      "position; or there is one fix for each time at the surface, which the agent gets "
      "as a reading and which does not correct the reckoned position");
  t->AddOptional("gps_first_fix_s", &c->gps_first_fix_s, "30.0", NonNegative(1e5), "s",
                 "time at the surface before the first fix");
  t->AddOptional("gps_period_s", &c->gps_period_s, "600.0", Positive(1e6), "s",
                 "time between two fixes of an AUV that stays at the surface, whose errors are "
                 "independent");
  t->Add("start_std_m", &c->start_std_m, NonNegative(1e4), "m, world ENU",
         "standard deviation of each horizontal component at the start of an episode");
  t->Add("current_std_mps", &c->current_std_mps, NonNegative(10), "m/s, world ENU",
         "standard deviation of the unknown current, which the stated uncertainty includes while "
         "the log does not reach the bottom");
}

}  // namespace

void Describe(NavigationConfig* c, config::Table* t) {
  t->Section("navigation");
  t->AddOptional("kind", config::Name(&c->kind, NavigationSystems().Names()), "perfect", kNone, "-",
                 "what an AUV knows of its own motion: the truth, or dead reckoning that drifts");
  const config::Owner owner{"navigation system", {"dead_reckoning"}, "navigation.kind", [c] {
                              return std::vector<std::string>{c->kind};
                            }};
  t->Thing(owner, "navigation.dead_reckoning", c, DescribeDeadReckoning);
  for (const char* key : {"gps_first_fix_s", "gps_period_s"}) {
    t->Own(
        std::string("navigation.dead_reckoning.") + key,
        {"use of fixes", {"reported"}, "navigation.dead_reckoning.fixes", [c] {
           return std::vector<std::string>{c->fixes == FixUse::kReported ? "reported" : "correct"};
         }});
  }
  for (const char* key : {"gps_std_m", "fixes", "gps_first_fix_s", "gps_period_s"}) {
    t->Own(std::string("navigation.dead_reckoning.") + key,
           {"navigation", {"with GPS"}, "navigation.dead_reckoning.gps_depth_m", [c] {
              return std::vector<std::string>{c->gps_depth_m > 0.0 ? "with GPS" : "without GPS"};
            }});
  }
  NavigationSystems().Describe("navigation", "navigation.kind", owner.chosen, &c->kinds, t);
  for (const char* key : {"period_s", "dvl_scale_std", "dvl_noise_mps", "dvl_altitude_m",
                          "heading_std_deg", "gyro_walk_deg_per_sqrt_h", "depth_std_m",
                          "gps_depth_m", "gps_std_m", "start_std_m", "current_std_mps"}) {
    t->Moved(std::string("navigation.") + key, std::string("navigation.dead_reckoning.") + key);
  }
}
}  // namespace stg::dynamics

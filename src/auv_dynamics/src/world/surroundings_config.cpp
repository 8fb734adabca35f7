#include "auv_dynamics/world/surroundings_config.hpp"

#include <string>
#include <vector>

namespace stg::dynamics {

using config::kFraction;
using config::NonNegative;
using config::Numbers;
using config::Positive;
using config::Within;

void Describe(CurrentConfig* c, config::Table* t) {
  t->Section("current");
  t->Add("velocity_mps", config::Numbers(&c->velocity_mps), config::Within(-10, 10),
         "m/s, world ENU", "constant, irrotational water current");
  t->AddOptional("layer_depth_m", Numbers(&c->layer_depth_m), "[0.0, 50.0, 100.0, 200.0]",
                 NonNegative(12000), "m", "depths of the layers' velocities, increasing");
  t->AddOptional("layer_east_mps", Numbers(&c->layer_east_mps), "[0.0, 0.0, 0.0, 0.0]",
                 Within(-10, 10), "m/s", "current to the east that is added at these depths");
  t->AddOptional("layer_north_mps", Numbers(&c->layer_north_mps), "[0.0, 0.0, 0.0, 0.0]",
                 Within(-10, 10), "m/s", "current to the north that is added at these depths");
  t->AddOptional("tide_mps", Numbers(&c->tide_mps), "[0.0, 0.0]", Within(-10, 10),
                 "m/s, east and north", "amplitude of a tidal current that is added");
  t->AddOptional("tide_period_s", &c->tide_period_s, "44714.2", Positive(1e8), "s",
                 "period of the tide");
  t->AddOptional("tide_phase_rad", &c->tide_phase_rad, "0.0", NonNegative(6.3), "rad",
                 "phase of the tide when an episode starts");
  t->AddOptional("random_mps", &c->random_mps, "[0.0, 0.0]", NonNegative(10), "m/s",
                 "[low, high] speed at each of the layers' depths, drawn per episode, of a current "
                 "that is added; its first direction is drawn, too");
  t->AddOptional("random_turn_deg", &c->random_turn_deg, "28.6", NonNegative(180), "deg",
                 "standard deviation of the turn of that current from one depth to the next");
  t->AddOptional("random_tide_mps", &c->random_tide_mps, "0.0", NonNegative(10), "m/s",
                 "amplitude of a tide that is added; its direction and phase are drawn");
  const config::Owner drawn{
      "current", {"drawn per episode"}, "current.random_mps", [c] {
        return std::vector<std::string>{c->random() ? "drawn per episode" : "given"};
      }};
  t->Own("current.random_turn_deg", drawn);
  t->Own("current.random_tide_mps", drawn);
}

std::optional<config::Violation> FindConflict(const CurrentConfig& c) {
  for (std::size_t k = 1; k < c.layer_depth_m.size(); ++k) {
    if (!(c.layer_depth_m[k] > c.layer_depth_m[k - 1])) {
      return config::Violation{{"current.layer_depth_m"}, "depths must increase"};
    }
  }
  return {};
}

void Describe(DisturbanceConfig* c, config::Table* t) {
  t->Section("disturbance");
  t->Add("force_std_n", &c->force_std_n, config::NonNegative(1e5), "N, body",
         "standard deviation of each force component of w in Eq. 3; 0: none");
  t->Add("moment_std_nm", &c->moment_std_nm, config::NonNegative(1e5), "N m, body",
         "standard deviation of each moment component of w; 0: none");
  t->Add("correlation_time_s", &c->correlation_time_s, config::Positive(1e5), "s",
         "correlation time of the Gauss-Markov disturbance");
}

void Describe(ContactConfig* c, config::Table* t) {
  t->Section("contact");
  t->Add("stiffness", &c->stiffness, config::NonNegative(1e7), "N/m",
         "contact force per metre of the softplus overlap; 0: AUVs pass through each other");
  t->Add("softness_m", &c->softness_m, config::Positive(1), "m",
         "length over which the contact force sets in");
}

void Describe(WorkspaceConfig* c, config::Table* t) {
  t->Section("workspace");
  t->Add("half_extent_m", &c->half_extent_m, config::Positive(1e5), "m, world ENU",
         "walls at +- this value on each axis");
  t->Add("restitution", &c->restitution, config::kFraction, "-",
         "kept share of the velocity component normal to a wall");
  t->Add("tangential", &c->tangential, config::kFraction, "-",
         "kept share of the velocity components along a wall");
  t->Add("body_velocity", &c->body_velocity, config::kFraction, "-",
         "kept share of the body velocity at a wall");
  t->Add("body_rate", &c->body_rate, config::kFraction, "-",
         "kept share of the body rates at a wall");
}

}  // namespace stg::dynamics

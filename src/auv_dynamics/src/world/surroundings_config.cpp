#include "auv_dynamics/world/surroundings_config.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace stg::dynamics {
namespace {

template <std::size_t N>
bool AnyOf(const std::array<double, N>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return v != 0.0; });
}

/// Keys that have an effect only if other keys are not zero.
config::Owner Only(const std::string& kind, const std::string& with, const std::string& without,
                   const std::string& key, const std::function<bool()>& has,
                   const std::vector<std::string>& other_keys = {}) {
  return {kind,
          {with},
          key,
          [=] { return std::vector<std::string>{has() ? with : without}; },
          other_keys};
}

}  // namespace

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
                 Within(-10, 10), "m/s", "eastward current at these depths, added to velocity_mps");
  t->AddOptional("layer_north_mps", Numbers(&c->layer_north_mps), "[0.0, 0.0, 0.0, 0.0]",
                 Within(-10, 10), "m/s",
                 "northward current at these depths, added to velocity_mps");
  t->AddOptional("tide_mps", Numbers(&c->tide_mps), "[0.0, 0.0]", Within(-10, 10),
                 "m/s, east and north", "amplitude of a tidal current, added to the others");
  t->AddOptional("tide_period_s", &c->tide_period_s, "44714.2", Positive(1e8), "s",
                 "period of the tide");
  t->AddOptional("tide_phase_rad", &c->tide_phase_rad, "0.0", NonNegative(6.3), "rad",
                 "phase of the tide at the start of an episode");
  t->AddOptional("random_mps", &c->random_mps, "[0.0, 0.0]", NonNegative(10), "m/s",
                 "[low, high] speed of an additional current, drawn per episode for each of the "
                 "layers' depths; its direction at the first depth is drawn, too");
  t->AddOptional(
      "random_turn_deg", &c->random_turn_deg, "28.6", NonNegative(180), "deg",
      "standard deviation of the turn of this additional current from one depth to the next");
  t->AddOptional(
      "random_tide_mps", &c->random_tide_mps, "0.0", NonNegative(10), "m/s",
      "amplitude of an additional tidal current; its direction and phase are drawn per episode");
  const config::Owner drawn{
      "current", {"drawn per episode"}, "current.random_mps", [c] {
        return std::vector<std::string>{c->random() ? "drawn per episode" : "given"};
      }};
  t->Own("current.random_turn_deg", drawn);
  t->Own("current.random_tide_mps", drawn);
  t->Own("current.layer_depth_m",
         Only("current", "in layers", "without layers", "current.layer_east_mps",
              [c] { return c->layered() || c->random(); },
              {"current.layer_north_mps", "current.random_mps"}));
  t->Own("current.tide_period_s",
         Only("current", "with a tide", "without a tide", "current.tide_mps",
              [c] { return c->tidal() || (c->random() && c->random_tide_mps > 0.0); },
              {"current.random_mps", "current.random_tide_mps"}));
  t->Own("current.tide_phase_rad", Only("current", "with a given tide", "without a given tide",
                                        "current.tide_mps", [c] { return c->tidal(); }));
}

bool CurrentConfig::layered() const { return AnyOf(layer_east_mps) || AnyOf(layer_north_mps); }

bool CurrentConfig::tidal() const { return AnyOf(tide_mps); }

double CurrentConfig::largest_mps() const {
  double layer = 0.0;
  for (std::size_t k = 0; k < layer_depth_m.size(); ++k) {
    layer = std::max(layer, std::hypot(layer_east_mps[k], layer_north_mps[k]));
  }
  const double drawn = random() ? random_mps.hi + random_tide_mps : 0.0;
  return std::hypot(velocity_mps[0], velocity_mps[1], velocity_mps[2]) + layer +
         std::hypot(tide_mps[0], tide_mps[1]) + drawn;
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
  t->Own("disturbance.correlation_time_s",
         Only("disturbance", "by force or moment", "none", "disturbance.force_std_n",
              [c] { return c->force_std_n > 0.0 || c->moment_std_nm > 0.0; },
              {"disturbance.moment_std_nm"}));
}

void Describe(ContactConfig* c, config::Table* t) {
  t->Section("contact");
  t->Add("stiffness", &c->stiffness, config::NonNegative(1e7), "N/m",
         "contact force per metre of the softplus overlap; 0: AUVs pass through each other");
  t->Add("softness_m", &c->softness_m, config::Positive(1), "m",
         "length over which the contact force sets in");
  t->Own("contact.softness_m", Only("contact", "with a force", "without a force",
                                    "contact.stiffness", [c] { return c->stiffness > 0.0; }));
}

void Describe(WorkspaceConfig* c, config::Table* t) {
  t->Section("workspace");
  t->Add("half_extent_m", &c->half_extent_m, config::Positive(1e5), "m, world ENU",
         "walls at +- this value on each axis");
  t->Add("restitution", &c->restitution, config::kFraction, "-",
         "share of the velocity normal to a wall that remains after contact");
  t->Add("tangential", &c->tangential, config::kFraction, "-",
         "share of the velocity along a wall that remains after contact");
  t->Add("body_velocity", &c->body_velocity, config::kFraction, "-",
         "share of the body velocity that remains after contact with a wall");
  t->Add("body_rate", &c->body_rate, config::kFraction, "-",
         "share of the body rates that remains after contact with a wall");
}

}  // namespace stg::dynamics

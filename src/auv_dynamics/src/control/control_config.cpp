#include "auv_dynamics/control/control_config.hpp"

namespace stg::dynamics {

using config::Enum;
using config::kNone;
using config::NonNegative;
using config::Within;

void Describe(ControlConfig* c, config::Table* t) {
  t->Section("control");
  t->Add("interface", config::Enum(&c->interface, {"velocity3", "tau6"}), config::kNone, "-",
         "action: desired world velocity (3), or body force and moment (6)");
  t->Add(
      "action_scale", &c->action_scale, config::Within(0.0, 1.0), "-",
      "training: the policy's mean action is this value times the tanh of its output (0.18 in the "
      "paper's force interface); a policy file keeps the value of its training");
  t->Add("max_delta", &c->max_delta, config::NonNegative(2), "-",
         "velocity3: largest change of an action per decision; 0: no limit");
  t->Add("smoothing", &c->smoothing, config::Within(0.0, 0.999), "-",
         "velocity3: weight alpha of the previous action in Eq. 27; 0: none");
  t->Add("velocity_gain", &c->velocity_gain, config::NonNegative(1e3), "-",
         "K_v of Eq. 24, times max_tau / max_velocity_mps");
  t->Add("attitude_gain", &c->attitude_gain, config::NonNegative(1e3), "1/rad",
         "K_eta of Eq. 25 for roll and pitch, as a share of the largest moment");
  t->Add("rate_gain", &c->rate_gain, config::NonNegative(1e3), "-",
         "K_omega of Eq. 25, as a share of the largest moment at the largest rate");
  t->Add("heading", config::Enum(&c->heading, {"free", "along_velocity"}), config::kNone, "-",
         "free: yaw is only damped; along_velocity: the bow points along the commanded velocity");
  t->Add("heading_gain", &c->heading_gain, config::NonNegative(1e3), "1/rad",
         "along_velocity: gain, as a share of the largest moment");
  const auto interface = [c] {
    const bool velocity = c->interface == ActionInterface::kVelocity3;
    return std::vector<std::string>{velocity ? "velocity3" : "tau6"};
  };
  for (const char* key : {"max_delta", "smoothing"}) {
    t->Own(std::string("control.") + key,
           {"action interface", {"velocity3"}, "control.interface", interface});
  }
  t->Own("control.heading_gain",
         {"heading", {"along_velocity"}, "control.heading", [c] {
            const bool free = c->heading == HeadingMode::kFree;
            return std::vector<std::string>{free ? "free" : "along_velocity"};
          }});
  Describe(&c->autopilot, t);
}

}  // namespace stg::dynamics

// A controller of your own, flown by an agent: it circles the target at a distance. See
// docs/how_to/add_a_controller.md.

#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "auv_common/plugin.hpp"
#include "stg_agent/agent/agent.hpp"
#include "stg_agent/controllers/controller.hpp"

namespace {

using namespace stg;
using namespace stg::agent;

struct Orbit {
  double radius_m = 0.2;
  double speed_mps = 0.05;
  double gain_per_s = 1.0;  // towards the circle

  template <class T>
  void Act(const ControllerInput<T>& in, T* action) const {
    const Knowledge<T>& k = in.knowledge;
    const Vec3<T> ahead = k.r_BT_W * (T(1.0) / Max(k.distance, T(1e-9)));
    const Vec3<T> around{ahead.y, -ahead.x, T(0.0)};  // level, anticlockwise
    const Vec3<T> v_des_W =
        k.v_WT + around * T(speed_mps) + ahead * ((k.distance - T(radius_m)) * T(gain_per_s));
    const auto& limit = in.model.vehicle.max_velocity_mps;
    const T velocity[3] = {Clip(v_des_W.x * T(1.0 / limit[0]), T(-1.0), T(1.0)),
                           Clip(v_des_W.y * T(1.0 / limit[1]), T(-1.0), T(1.0)),
                           Clip(v_des_W.z * T(1.0 / limit[2]), T(-1.0), T(1.0))};
    AskForVelocity(in, velocity, action);
  }
};

void Describe(Orbit* o, config::Table* t) {
  t->Add("radius", &o->radius_m, config::Positive(100), "m", "radius of the circle");
  t->Add("speed", &o->speed_mps, config::NonNegative(10), "m/s", "speed along the circle");
  t->Add("gain", &o->gain_per_s, config::NonNegative(10), "1/s",
         "speed towards the circle per distance from it");
}

std::unique_ptr<Controller> MakeOrbit(const Orbit& orbit) {
  return std::make_unique<ControllerOf<Orbit>>(orbit);
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN { Controllers().Add("orbit", MakeOrbit); }

int main() {
  stg_plugin_register();

  AgentModel config;
  config.run.agents = 1;
  // The vehicle moves exactly as commanded.
  config.control.smoothing = config.control.max_delta = 0.0;
  config.run.time.decision_steps = 1;
  Agent agent(config, 0);
  const Vec3<double> p_WT{0.1, 0.0, 0.0};
  dynamics::Cue cue;
  cue.p_WT = p_WT;
  agent.Reset(0, cue);

  const auto controller = MakeController("orbit:radius=0.3,speed=0.06");
  dynamics::NavState nav;
  nav.p_WB = {-0.1, -0.1, 0.0};
  std::vector<float> observation(static_cast<std::size_t>(config.observation_size()));
  const double dt = config.run.decision_dt_s();
  double turned = 0.0;  // in the last 10 s [rad]
  for (int k = 0; k < static_cast<int>(60.0 / dt); ++k) {
    agent.Detect({nav.stamp, 0, p_WT, 0.0});
    agent.Observe(nav, observation.data());
    float action[dynamics::kMaxActionSize];
    controller->Act(agent.view(), action);
    nav.v_WB_B = agent.Act(action).cmd_vel_W;  // level and unturned: body axes are world axes
    const Vec3<double> before = nav.p_WB - p_WT;
    nav.p_WB += nav.v_WB_B * dt;
    nav.stamp += config.run.decision_period();
    const Vec3<double> after = nav.p_WB - p_WT;
    const Vec3<double> moment = Cross(before, after);
    if (k >= static_cast<int>(50.0 / dt)) turned += std::atan2(moment.z, Dot(before, after));
  }
  const double distance = Norm(nav.p_WB - p_WT);
  std::printf("circles at %.4f m, %.4f rad/s\n", distance, turned / 10.0);
  // A step along the tangent leads outwards, so the distance is a little larger than commanded, and
  // the turn rate is v / r.
  return std::abs(distance - 0.3) < 0.003 && std::abs(turned / 10.0 - 0.2) < 0.003 ? 0 : 1;
}

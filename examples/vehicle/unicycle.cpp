// A vehicle of your own: it takes a speed and a turn rate, reaches them with a first-order lag, and
// stays at its depth. Its autopilot lets controllers and policies fly it. See
// docs/how_to/add_a_vehicle.md.

#include <cmath>
#include <cstdio>

#include "auv_common/config/loader.hpp"
#include "auv_common/plugin.hpp"
#include "auv_dynamics/autopilot/autopilot.hpp"
#include "auv_dynamics/world/world.hpp"

namespace {

using namespace stg;
using namespace stg::dynamics;

struct UnicycleOptions {
  double lag_s = 2.0;
};

void Describe(UnicycleOptions* o, config::Table* t) {
  t->Add("lag_s", &o->lag_s, config::Positive(1e3), "s", "time constant of speed and turn rate");
}

class Unicycle : public Vehicle {
 public:
  Unicycle(const UnicycleOptions& options, const VehicleConfig& config)
      : lag_s_(options.lag_s),
        actuators_{{"speed", "m/s", 0.0, config.max_velocity_mps[0]},
                   {"turn_rate", "rad/s", -config.max_rate_radps[2], config.max_rate_radps[2]}},
        actions_(VelocityActions(config)) {}

  const Space& actuators() const override { return actuators_; }
  const Space& actions() const override { return actions_; }
  int internal_size() const override { return 1; }  // speed through the water

  void Step(const Pack* command, const Surroundings& around, double dt, VehicleState<Pack>* state,
            Pack* internal) const override {
    const Pack share(1.0 - std::exp(-dt / lag_s_));
    Pack& speed = internal[0];
    Pack& rate = state->w_WB_B.z;
    speed += (Within(0, command[0]) - speed) * share;
    rate += (Within(1, command[1]) - rate) * share;

    state->rpy.z = WrapAngle(state->rpy.z + rate * Pack(dt));
    QuaternionOf(state->rpy, &state->q_WB);
    const Mat3<Pack> R_WB = RotationOf(state->q_WB);
    const Vec3<Pack> v_WB = R_WB * Vec3<Pack>{speed, Pack(0.0), Pack(0.0)} + around.v_WC;
    state->p_WB += v_WB * Pack(dt);
    state->v_WB_B = R_WB.TransposeTimes(v_WB);
    FollowQuaternion(state);  // R_WB, trig and v_WB
  }

 private:
  Pack Within(std::size_t k, const Pack& x) const {
    return Clip(x, actuators_[k].lo, actuators_[k].hi);
  }

  double lag_s_;
  Space actuators_, actions_;
};

struct UnicycleAutopilotOptions {
  double turn_first_rad = 3.2;
};

void Describe(UnicycleAutopilotOptions* o, config::Table* t) {
  t->Add("turn_first_rad", &o->turn_first_rad, config::Positive(3.2), "rad",
         "with a larger course error, the vehicle turns before it drives");
}

/// Turns towards the commanded velocity, and drives with its component along the heading.
class UnicycleAutopilot : public Autopilot {
 public:
  UnicycleAutopilot(const UnicycleAutopilotOptions& options, const VehicleConfig& vehicle,
                    const AutopilotConfig& config)
      : speed_mps_(vehicle.max_velocity_mps[0]),
        turn_radps_(vehicle.max_rate_radps[2]),
        gain_ps_(config.course_gain_ps),
        turn_first_rad_(options.turn_first_rad) {}

  int state_size() const override { return 0; }
  void Steer(const Vec3<double>& v_des_W, const Navigation<double>& nav, double, double*,
             double* command) const override {
    Follow(v_des_W, nav, command);
  }
  void Steer(const Vec3<Pack>& v_des_W, const Navigation<Pack>& nav, double, Pack*,
             Pack* command) const override {
    Follow(v_des_W, nav, command);
  }

 private:
  template <class T>
  void Follow(const Vec3<T>& v_des_W, const Navigation<T>& nav, T* command) const {
    const Vec3<T> v_des_B = RotationOf(nav.q_WB).TransposeTimes(v_des_W);
    const Mask<T> moves = v_des_B.x * v_des_B.x + v_des_B.y * v_des_B.y > T(1e-12);
    const T error = Atan2(Select(moves, v_des_B.y, T(0.0)), Select(moves, v_des_B.x, T(1.0)));
    const T speed = Clip(v_des_B.x, T(0.0), T(speed_mps_));
    command[0] = Select(error * error > T(turn_first_rad_ * turn_first_rad_), T(0.0), speed);
    command[1] = Clip(error * T(gain_ps_), T(-turn_radps_), T(turn_radps_));
  }

  double speed_mps_, turn_radps_, gain_ps_, turn_first_rad_;
};

std::unique_ptr<const Vehicle> MakeUnicycle(const UnicycleOptions& options,
                                            const VehicleConfig& config) {
  return std::make_unique<Unicycle>(options, config);
}

std::unique_ptr<const Autopilot> MakeAutopilot(const UnicycleAutopilotOptions& options,
                                               const VehicleConfig& vehicle,
                                               const AutopilotConfig& config) {
  return std::make_unique<UnicycleAutopilot>(options, vehicle, config);
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN {
  Vehicles().Add("unicycle", MakeUnicycle);
  Autopilots().Add("unicycle", MakeAutopilot);
}

int main() {
  stg_plugin_register();

  WorldScenario
      config;  // or config::Load<WorldScenario>({file}), where the file says model: unicycle
  config.run.agents = 1;
  config::Override(&config, {"vehicle.model=unicycle", "vehicle.unicycle.lag_s=1.5"});
  config.world.workspace.half_extent_m = 100.0;
  World world(config);
  world.Place(0, {{0.0, 0.0, -5.0}}, {{20.0, 0.0, -5.0}}, {{0.0, 0.0, 0.0}});

  // At 1 m/s and 0.1 rad/s it ends on a circle of 10 m.
  const std::vector<Pack> command{Pack(1.0), Pack(0.1)};
  for (int k = 0; k < 600; ++k) world.Step(command);
  const NavState nav = world.Nav(0, 0);
  const double radius = Norm(nav.v_WB_B) / nav.w_WB_B.z;
  std::printf("after %.0f s: at (%.2f, %.2f, %.2f) m, turning circle %.3f m\n",
              1e-9 * static_cast<double>(nav.stamp), nav.p_WB.x, nav.p_WB.y, nav.p_WB.z, radius);
  return std::abs(radius - 10.0) < 1e-6 && nav.p_WB.z == -5.0 ? 0 : 1;
}

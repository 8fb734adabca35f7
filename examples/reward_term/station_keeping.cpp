// A reward term of your own: an AUV must move with its target's velocity. See
// docs/how_to/add_a_reward_term.md.

#include <cmath>
#include <cstdio>

#include "auv_common/config/loader.hpp"
#include "auv_common/plugin.hpp"
#include "stg_env/scenario/scenario.hpp"
#include "stg_env/task/task.hpp"

namespace {

using namespace stg;
using namespace stg::task;

/// Minus the speed relative to the target, as a share of the vehicle's largest speed, and at most
/// 1. The term is in [-1, 0], and 0 for an AUV with its target's velocity.
struct StationKeepingOptions {
  double full_share = 1.0;
};

void Describe(StationKeepingOptions* o, config::Table* t) {
  t->Add("full_share", &o->full_share, config::Positive(10), "-",
         "share of the largest speed that costs all of the weight");
}

class StationKeeping : public TermOf<StationKeeping> {
 public:
  StationKeeping(const StationKeepingOptions& options, const JudgeConfig& config)
      : options_(options), config_(config) {}

  template <class T>
  T Of(const TermInput<T>& in) const {
    const auto i = static_cast<std::size_t>(in.agent);
    const auto k = static_cast<std::size_t>(config_.world.target.of(in.agent));
    const T speed = Norm(in.swarm.vehicles[i].v_WB - in.swarm.targets[k].v_WT);
    return -Min(speed * T(1.0 / (options_.full_share * config_.world.vehicle.max_velocity_mps[0])),
                T(1.0));
  }

 private:
  StationKeepingOptions options_;
  JudgeConfig config_;
};

std::unique_ptr<const RewardTerm> MakeStationKeeping(const StationKeepingOptions& options,
                                                     const JudgeConfig& config) {
  return std::make_unique<StationKeeping>(options, config);
}

/// Reward of one AUV at rest near a target with this speed, as a share of the largest speed.
double Earned(double share, double weight) {
  Scenario config;
  config.run.agents = 1;
  if (weight > 0.0) {
    config::Override(&config, {"reward.terms.station_keeping.weight=" + std::to_string(weight),
                               "reward.terms.station_keeping.full_share=0.5"});
  }

  std::vector<dynamics::VehicleState<double>> vehicles(1);
  std::vector<dynamics::TargetState<double>> targets(1);
  targets[0].p_WT = {config.agent.task.desired_distance_m, 0.0, 0.0};
  targets[0].v_WT = {0.0, share * config.world.vehicle.max_velocity_mps[0], 0.0};
  dynamics::Separations<double> separations(1, 0.0);
  separations.Measure(vehicles);
  const Efforts<double> idle(1);
  const SwarmState<double> swarm{vehicles, targets, separations, idle, idle};

  Task<double> task(config.judge());
  task.Start(true, swarm, 500.0);
  task.Step(swarm);
  return task.terms(0).total;
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN { RewardTermsByName().Add("station_keeping", MakeStationKeeping); }

int main() {
  stg_plugin_register();

  // The full share is 0.5, so a quarter of the largest speed costs half of the weight.
  const double quarter = Earned(0.25, 0.5) - Earned(0.25, 0.0);
  const double most = Earned(3.0, 0.5) - Earned(3.0, 0.0);
  std::printf("of a weight of 0.5, a quarter of the speed costs %.4f, three times it %.4f\n",
              -quarter, -most);
  return std::abs(quarter + 0.25) < 1e-9 && std::abs(most + 0.5) < 1e-9 ? 0 : 1;
}

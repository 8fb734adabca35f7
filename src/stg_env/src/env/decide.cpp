#include "stg_env/env/decide.hpp"

#include "acoustic_channel/models/range.hpp"
#include "auv_common/error.hpp"
#include "environment.hpp"
#include "sources/acoustic_source.hpp"
#include "stg_agent/agent/agent_view.hpp"
#include "stg_agent/controllers/idle.hpp"

namespace stg::env {
namespace {

/// Decides from true states, in all lanes of a slice at once.
void DecideTruly(const agent::Controller& c, const VectorEnv::Slice& slice, double* actions) {
  const Environment& env = *slice.lanes;
  const dynamics::World& world = env.world();
  const agent::AgentModel& s = env.model();
  const int n = s.run.agents, size = s.control.action_size();
  std::vector<agent::NeighbourSight<Pack>> neighbours(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    int count = 0;
    for (int j = 0; j < n; ++j) {
      if (j == i) continue;
      agent::NeighbourSight<Pack>& seen = neighbours[static_cast<std::size_t>(count++)];
      seen.known = Pack(1.0);
      seen.p_W = seen.p_WN = world.vehicle(j).p_WB;
      seen.v_W = world.vehicle(j).v_WB;
      seen.tracking_error = env.task().tracking(j).error;
      seen.r_BN_W = seen.p_WN - world.vehicle(i).p_WB;
      seen.distance_m = world.distance(i, j);
      seen.link_quality = acoustics::RangeQuality(seen.distance_m, s.channel.range_m);
    }
    Pack a[dynamics::kMaxActionSize];
    c.Act({s, i, env.Truth(i), neighbours.data(), count}, a);
    for (int lane = 0; lane < slice.count; ++lane) {
      double* out = actions + ((slice.first + lane) * n + i) * size;
      for (int k = 0; k < size; ++k) out[k] = Lane(a[k], lane);
    }
  }
}

void DecideSlice(const agent::Decider& c, const VectorEnv::Slice& slice, const float* observations,
                 double* actions) {
  const Scenario& s = slice.lanes->scenario();
  const int n = s.run.agents, size = s.world.control.action_size();
  const int width = s.agent.observation_size();
  if (c.entities != nullptr && s.mode == InformationMode::kTruth) {
    throw UserError("policy '" + c.name +
                    "' uses only an AUV's own knowledge, so mode must be acoustic; the scenario '" +
                    s.run.name + "' has the mode truth");
  }
  if (c.builtin != nullptr && (c.privileged || s.mode == InformationMode::kTruth)) {
    DecideTruly(*c.builtin, slice, actions);
    return;
  }
  float a[dynamics::kMaxActionSize];
  for (int row = 0; row < slice.count * n; ++row) {
    if (c.observes()) {
      c.Act(row % n, observations + static_cast<std::ptrdiff_t>(slice.first * n + row) * width, a);
    } else {
      c.Act(slice.lanes->acoustic().agent(row % n).view(row / n), a);
    }
    double* out = actions + (slice.first * n + row) * size;
    for (int k = 0; k < size; ++k) out[k] = static_cast<double>(a[k]);
  }
}

}  // namespace

void ReadTruth(agent::Decider* decider, InformationMode mode) {
  if (decider->builtin == nullptr) {
    throw UserError("privileged: only a built-in controller can read true states, but '" +
                    decider->name + "' is a policy");
  }
  if (mode == InformationMode::kTruth) {
    throw UserError(
        "privileged: the scenario has the mode truth, in which each controller reads true states "
        "anyway");
  }
  if (dynamic_cast<const agent::ControllerOf<agent::Idle>*>(decider->builtin.get()) != nullptr) {
    throw UserError("privileged: '" + decider->name + "' reads no states");
  }
  decider->privileged = true;
}

void Decide(const agent::Decider& c, const VectorEnv& env, const float* observations,
            double* actions) {
  for (const VectorEnv::Slice& slice : env.slices()) DecideSlice(c, slice, observations, actions);
}

}  // namespace stg::env

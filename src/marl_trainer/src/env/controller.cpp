#include "marl_trainer/env/controller.hpp"

#include <algorithm>

#include "acoustic_source.hpp"
#include "auv_dynamics/control/control.hpp"
#include "environment.hpp"
#include "stg_agent/agent/agent.hpp"

namespace stg::env {
namespace {

void DecideTruth(const Controller& c, const VectorEnv::Slice& slice, double* actions) {
  const Environment& env = *slice.lanes;
  const Scenario& s = env.scenario();
  const int n = s.agents, size = s.action_size();
  std::vector<Vec3<Pack>> neighbours(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) {
    int count = 0;
    for (int j = 0; j < n; ++j) {
      if (j != i) {
        neighbours[static_cast<size_t>(count++)] =
            env.world().vehicle(j).p_WB - env.world().vehicle(i).p_WB;
      }
    }
    Pack a[6];
    agent::Knowledge<Pack> k;  // what the law reads of it
    k.p_WB = env.world().vehicle(i).p_WB;
    k.r_BT_W = env.task().tracking(i).r_BT_W;
    k.v_WT = env.world().target(s.target_of(i)).v_WT;
    agent::PursuitAction(c.options, s, k, neighbours.data(), count, a);
    if (s.control.interface == dynamics::ActionInterface::kTau6) {
      const dynamics::VehicleState<Pack>& v = env.world().vehicle(i);
      Pack fraction[6];
      dynamics::VelocityController(s.control, s.vehicle, dynamics::DesiredVelocity(s.vehicle, a),
                                   v.R_WB, v.v_WB, RpyOf(v.trig), v.w_WB_B, fraction);
      std::copy(fraction, fraction + 6, a);
    }
    for (int lane = 0; lane < slice.count; ++lane) {
      double* out = actions + ((slice.first + lane) * n + i) * size;
      for (int k2 = 0; k2 < size; ++k2) out[k2] = Lane(a[k2], lane);
    }
  }
}

void Decide(const Controller& c, const VectorEnv::Slice& slice, const float* observations,
            double* actions) {
  const Scenario& s = slice.lanes->scenario();
  const int n = s.agents, size = s.action_size(), width = s.observation_size();
  const bool truth = c.privileged || s.mode == InformationMode::kTruth;
  if (c.policy == nullptr && c.builtin != agent::BuiltinKind::kIdle && truth) {
    DecideTruth(c, slice, actions);
    return;
  }
  float a[6] = {};
  for (int row = 0; row < slice.count * n; ++row) {
    if (c.policy != nullptr) {
      c.policy->Mean(observations + static_cast<std::ptrdiff_t>(slice.first * n + row) * width, a);
    } else if (c.builtin != agent::BuiltinKind::kIdle) {
      agent::BuiltinAction(c.builtin, c.options,
                           slice.lanes->acoustic().agent(row % n).agent(row / n), a);
    }
    double* out = actions + (slice.first * n + row) * size;
    for (int k = 0; k < size; ++k) out[k] = static_cast<double>(a[k]);
  }
}

}  // namespace

Controller MakeController(const std::string& name, const Scenario& scenario) {
  Controller c;
  c.name = name;
  if (agent::ParseBuiltin(name, &c.builtin, &c.options)) return c;
  auto policy = std::make_shared<agent::Policy>(agent::Policy::LoadOnnx(name));
  policy->RequireFits(scenario);
  c.policy = policy;
  return c;
}

void Decide(const Controller& c, const VectorEnv& env, const float* observations, double* actions) {
  for (const VectorEnv::Slice& slice : env.slices()) Decide(c, slice, observations, actions);
}

}  // namespace stg::env

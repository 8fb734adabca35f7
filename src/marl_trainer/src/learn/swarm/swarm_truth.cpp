#include "marl_trainer/learn/swarm/swarm_truth.hpp"

#include <algorithm>
#include <cmath>

namespace stg::learn {
namespace {

class CriticRow {
 public:
  explicit CriticRow(float* out) : out_(out) {}
  CriticRow& Put(double x) {
    *out_++ = static_cast<float>(std::clamp(x, -3.0, 3.0));
    return *this;
  }

 private:
  float* out_;
};

}  // namespace

agent::PoolSpec SwarmCriticSpec() {
  agent::PoolSpec spec;
  spec.self = kCriticSelf;
  spec.sets = {kCriticTarget, kCriticOther};
  spec.outputs = 1;
  return spec;
}

void ReadTruth(const env::VectorEnv& env, int e, SwarmTruth* truth) {
  const Scenario& s = env.scenario(e);
  truth->scales = agent::EntityScales(s.model());
  truth->desired_m = s.agent.task.desired_distance_m;
  truth->p_WB.clear();
  truth->v_WB.clear();
  truth->present.clear();
  truth->targets.clear();
  truth->followed.clear();
  truth->r_BT_W.clear();
  for (int k = 0; k < s.world.target.count; ++k) truth->targets.push_back(env.target(e, k));
  for (int i = 0; i < env.agents(); ++i) {
    const dynamics::VehicleState<double> vehicle = env.vehicle(e, i);
    truth->p_WB.push_back(vehicle.p_WB);
    truth->v_WB.push_back(vehicle.v_WB);
    truth->present.push_back(env.present(e, i) ? 1 : 0);
    truth->followed.push_back(env.followed(e, i));
    truth->r_BT_W.push_back(env.knowledge(e, i).r_BT_W);
  }
}

void AddCriticRow(const SwarmTruth& truth, int i, const agent::Entities& entities,
                  PackedRows* rows) {
  const auto u = static_cast<std::size_t>(i);
  const int target = truth.followed[u];
  const agent::EntityScales& scales = truth.scales;
  const double desired = truth.desired_m;
  const Vec3<double>& p_WB = truth.p_WB[u];
  const Vec3<double>& v_WB = truth.v_WB[u];
  const dynamics::TargetState<double>& goal = truth.targets[static_cast<std::size_t>(target)];
  const Vec3<double> r = goal.p_WT - p_WB;
  const double level = std::max(std::hypot(r.x, r.y), 1e-6), distance = Norm(r);
  const double lx = r.x / level, ly = r.y / level;
  const auto along = [&](const Vec3<double>& v) { return v.x * lx + v.y * ly; };
  const auto across = [&](const Vec3<double>& v) { return v.y * lx - v.x * ly; };
  const double speed = std::hypot(v_WB.x, v_WB.y);
  const double c = speed > 1e-6 ? v_WB.x / speed : 1.0;
  const double n = speed > 1e-6 ? v_WB.y / speed : 0.0;
  const auto ahead = [&](const Vec3<double>& v) { return c * v.x + n * v.y; };
  const auto aport = [&](const Vec3<double>& v) { return c * v.y - n * v.x; };

  float self[kCriticSelf];
  std::copy(entities.self, entities.self + agent::kSelfNumbers, self);
  CriticRow extra(self + agent::kSelfNumbers);
  const bool known = entities.targets > 0;
  const Vec3<double> error = known ? truth.r_BT_W[u] - r : Vec3<double>{};
  extra.Put(along(error) / (60.0 * scales.length)).Put(across(error) / (60.0 * scales.length));
  extra.Put(known ? static_cast<double>(scales.Deviation(Norm(error))) : 3.0);
  for (const int k : {11, 12, 21, 24, 25, 29}) {
    extra.Put(known ? static_cast<double>(entities.target[0][k]) : 0.0);
  }

  float goals[kCriticTarget];
  CriticRow g(goals);
  g.Put(ahead(r) / level).Put(aport(r) / level);
  g.Put(static_cast<double>(scales.Far(distance)));
  g.Put(static_cast<double>(scales.Band(distance, desired)));
  g.Put(static_cast<double>(scales.Middle(distance, desired)));
  g.Put(r.z / (40.0 * scales.length))
      .Put(scales.Speed(along(goal.v_WT)))
      .Put(scales.Speed(across(goal.v_WT)));
  g.Put(scales.Speed(along(v_WB))).Put(scales.Speed(across(v_WB)));
  g.Put((across(goal.v_WT) - across(v_WB)) / std::max(level, scales.length) * 60.0 * scales.time);

  float others[64][kCriticOther];
  int count = 0;
  for (std::size_t j = 0; j < truth.p_WB.size() && count < 64; ++j) {
    if (j == u || truth.present[j] == 0) continue;
    const Vec3<double> d = truth.p_WB[j] - p_WB, w = truth.v_WB[j] - v_WB, q = d - r;
    const double flat = std::max(std::hypot(d.x, d.y), 1e-6), apart = Norm(d), far = Norm(q);
    const double both = std::max(std::hypot(q.x, q.y) * level, 1e-9);
    CriticRow o(others[count++]);
    o.Put(ahead(d) / flat).Put(aport(d) / flat);
    o.Put(static_cast<double>(scales.Far(apart))).Put((apart - scales.apart_m) / scales.apart_m);
    o.Put(d.z / scales.apart_m).Put(scales.Speed(ahead(w))).Put(scales.Speed(aport(w)));
    o.Put(static_cast<double>(scales.Far(far)));
    o.Put(static_cast<double>(scales.Band(far, desired)));
    o.Put(-(q.x * r.x + q.y * r.y) / both).Put((q.x * r.y - q.y * r.x) / both);
    o.Put(truth.followed[j] == target ? 1.0 : 0.0);
  }
  const agent::PoolRows sets[2] = {{goals, 1, kCriticTarget}, {others[0], count, kCriticOther}};
  rows->Add(self, nullptr, sets);
}

}  // namespace stg::learn

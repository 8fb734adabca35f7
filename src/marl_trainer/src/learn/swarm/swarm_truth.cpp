#include "marl_trainer/learn/swarm/swarm_truth.hpp"

#include <algorithm>
#include <cmath>

namespace stg::learn {
namespace {

constexpr double kSpeed = 2.3;

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

void AddCriticRow(const env::VectorEnv& env, int e, int i, const agent::Entities& entities,
                  PackedRows* rows) {
  const Scenario& s = env.scenario(e);
  const int target = env.followed(e, i);
  const double desired = s.agent.task.desired_distance_m;
  const dynamics::VehicleState<double> own = env.vehicle(e, i);
  const dynamics::TargetState<double> goal = env.target(e, target);
  const Vec3<double> r = goal.p_WT - own.p_WB;
  const double level = std::max(std::hypot(r.x, r.y), 1e-6), distance = Norm(r);
  const double lx = r.x / level, ly = r.y / level;
  const auto along = [&](const Vec3<double>& v) { return v.x * lx + v.y * ly; };
  const auto across = [&](const Vec3<double>& v) { return v.y * lx - v.x * ly; };
  const double speed = std::hypot(own.v_WB.x, own.v_WB.y);
  const double c = speed > 1e-6 ? own.v_WB.x / speed : 1.0;
  const double n = speed > 1e-6 ? own.v_WB.y / speed : 0.0;
  const auto ahead = [&](const Vec3<double>& v) { return c * v.x + n * v.y; };
  const auto aport = [&](const Vec3<double>& v) { return c * v.y - n * v.x; };

  float self[kCriticSelf];
  std::copy(entities.self, entities.self + agent::kSelfNumbers, self);
  CriticRow extra(self + agent::kSelfNumbers);
  const bool known = entities.targets > 0;
  const Vec3<double> error = known ? env.knowledge(e, i).r_BT_W - r : Vec3<double>{};
  extra.Put(along(error) / 60.0).Put(across(error) / 60.0);
  extra.Put(known ? static_cast<double>(agent::DeviationScale(Norm(error))) : 3.0);
  for (const int k : {11, 12, 21, 24, 25, 29}) {
    extra.Put(known ? static_cast<double>(entities.target[0][k]) : 0.0);
  }

  float goals[kCriticTarget];
  CriticRow g(goals);
  g.Put(ahead(r) / level).Put(aport(r) / level);
  g.Put(static_cast<double>(agent::FarScale(distance)));
  g.Put(static_cast<double>(agent::BandScale(distance, desired)));
  g.Put(static_cast<double>(agent::MiddleScale(distance, desired)));
  g.Put(r.z / 40.0).Put(along(goal.v_WT) / kSpeed).Put(across(goal.v_WT) / kSpeed);
  g.Put(along(own.v_WB) / kSpeed).Put(across(own.v_WB) / kSpeed);
  g.Put((across(goal.v_WT) - across(own.v_WB)) / std::max(level, 1.0) * 60.0);

  float others[64][kCriticOther];
  int count = 0;
  for (int j = 0; j < env.agents() && count < 64; ++j) {
    if (j == i) continue;
    const dynamics::VehicleState<double> mate = env.vehicle(e, j);
    const Vec3<double> d = mate.p_WB - own.p_WB, w = mate.v_WB - own.v_WB, q = d - r;
    const double flat = std::max(std::hypot(d.x, d.y), 1e-6), apart = Norm(d), far = Norm(q);
    const double both = std::max(std::hypot(q.x, q.y) * level, 1e-9);
    CriticRow o(others[count++]);
    o.Put(ahead(d) / flat).Put(aport(d) / flat);
    o.Put(static_cast<double>(agent::FarScale(apart))).Put((apart - 20.0) / 20.0).Put(d.z / 20.0);
    o.Put(ahead(w) / kSpeed).Put(aport(w) / kSpeed);
    o.Put(static_cast<double>(agent::FarScale(far)));
    o.Put(static_cast<double>(agent::BandScale(far, desired)));
    o.Put(-(q.x * r.x + q.y * r.y) / both).Put((q.x * r.y - q.y * r.x) / both);
    o.Put(env.followed(e, j) == target ? 1.0 : 0.0);
  }
  const agent::PoolRows sets[2] = {{goals, 1, kCriticTarget}, {others[0], count, kCriticOther}};
  rows->Add(self, nullptr, sets);
}

}  // namespace stg::learn

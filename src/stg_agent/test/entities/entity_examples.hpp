#pragma once

#include <cmath>
#include <vector>

#include "auv_common/numbers/attitude.hpp"
#include "auv_common/numbers/random.hpp"
#include "stg_agent/entities/entities.hpp"

/// A made-up AUV of the field and everything around it, for the tests of entities.
namespace stg::agent {

inline AgentModel FieldModel(int agents = 6) {
  AgentModel m;
  m.run.agents = agents;
  m.run.time.dt_s = 0.05;
  m.run.time.decision_steps = 20;
  m.sea.open = true;
  m.sea.spheres = {{60.0, 40.0, -40.0, 12.0}, {-150.0, 90.0, -30.0, 20.0}};
  m.sea.cylinders = {{10.0, -120.0, -120.0, 8.0, 100.0}};
  m.vehicle.max_velocity_mps = {2.3, 2.3, 0.5};
  m.task.desired_distance_m = 90.0;
  m.sensing.range_m = 600.0;
  m.observation.error_scale_m = 600.0;
  m.channel.access = "tdma";
  m.channel.slots.length_s = 1.25;
  return m;
}

/// Everything that an AUV knows: memory, neighbours and packets are a part of it.
struct EntityExample {
  AgentModel model = FieldModel();
  Knowledge<double> knowledge;
  EntityMemory memory;
  TargetBelief belief;
  std::vector<NeighbourState> reports;
  std::vector<EntityNeighbour> neighbours;

  EntityInput input() const {
    EntityInput in{model, 1, 0, knowledge, memory, belief};
    in.velocity_std_mps = 0.2;
    in.information_age_s = 4.0;
    in.neighbours = neighbours.data();
    in.neighbour_count = static_cast<int>(neighbours.size());
    return in;
  }
};

inline void Orient(double yaw, Knowledge<double>* k) {
  k->trig = {std::sin(0.02),  std::cos(0.02), std::sin(-0.05),
             std::cos(-0.05), std::sin(yaw),  std::cos(yaw)};
  k->R_WB = RotationOf(k->trig);
  k->v_WB = k->R_WB * k->v_WB_B;
}

/// The example of a seed. The world is turned by `turn` about the z axis through its origin.
inline EntityExample MakeExample(unsigned seed, int neighbours, double turn = 0.0) {
  EntityExample x;
  Random random(seed, Stream::kReset, 0, 0, 0);
  const auto u = [&random](double most) { return random.Uniform(-most, most); };
  const double c = std::cos(turn), s = std::sin(turn);
  const auto turned = [c, s](const Vec3<double>& v) {
    return Vec3<double>{c * v.x - s * v.y, s * v.x + c * v.y, v.z};
  };
  Knowledge<double>& k = x.knowledge;
  k.p_WB = turned({u(50.0), u(50.0), -35.0 + u(5.0)});
  k.v_WB_B = {1.4 + u(0.3), u(0.2), u(0.1)};
  k.w_WB_B = {u(0.02), u(0.02), u(0.08)};
  Orient(u(3.0) + turn, &k);
  k.r_BT_W = turned({u(200.0), u(200.0), u(10.0)});
  k.v_WT = turned({u(0.9), u(0.9), 0.0});
  k.distance = Norm(k.r_BT_W);
  k.previous_distance = k.distance + 0.7;
  k.error = std::abs(k.distance - 90.0);
  k.mean_error = k.error + 2.0;
  k.confidence = 0.8;
  x.memory.now = 93'000'000'000;
  x.memory.position_std_m = 3.0;
  x.memory.own_detection[0] = 90'000'000'000;
  x.memory.command = {0.1F, -0.2F, 0.3F, 0.0F, -0.4F};
  x.belief.started = true;
  // The covariance has an axis of its own, which turns with the world.
  const double a = 0.4 + turn, l1 = 144.0, l2 = 16.0;
  x.belief.P_WT = {l1 * std::cos(a) * std::cos(a) + l2 * std::sin(a) * std::sin(a),
                   (l1 - l2) * std::cos(a) * std::sin(a),
                   0.0,
                   l1 * std::sin(a) * std::sin(a) + l2 * std::cos(a) * std::cos(a),
                   0.0,
                   9.0};
  for (auto& b : x.model.sea.spheres) {
    const Vec3<double> p = turned({b[0], b[1], b[2]});
    b[0] = p.x;
    b[1] = p.y;
  }
  for (auto& b : x.model.sea.cylinders) {
    const Vec3<double> p = turned({b[0], b[1], b[2]});
    b[0] = p.x;
    b[1] = p.y;
  }
  x.reports.resize(static_cast<std::size_t>(neighbours));
  for (int j = 0; j < neighbours; ++j) {
    NeighbourState& r = x.reports[static_cast<std::size_t>(j)];
    r.source = j;
    r.phase = j % 4;
    r.confidence = 0.5 + u(0.4);
    r.position_std_m = 2.0 + u(1.0);
    if (j % 2 == 1) r.sightings.push_back({}).stamp = 60'000'000'000;
    NeighbourSight<double> sight;
    sight.known = 1.0;
    sight.age_s = 3.0 + 2.0 * j;
    sight.v_W = turned({u(1.5), u(1.5), 0.0});
    sight.r_BN_W = turned({u(250.0), u(250.0), u(15.0)});
    sight.p_WN = k.p_WB + sight.r_BN_W;
    sight.distance_m = Norm(sight.r_BN_W);
    sight.link_quality = 0.5 + u(0.5);
    sight.tracking_error = 20.0 + u(19.0);
    x.neighbours.push_back({sight, &r});
  }
  return x;
}

}  // namespace stg::agent

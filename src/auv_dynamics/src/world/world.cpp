#include "auv_dynamics/world/world.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "auv_common/config/loader.hpp"
#include "auv_common/numbers/random.hpp"
#include "auv_dynamics/vehicle/integrator.hpp"
#include "auv_dynamics/vehicle/vehicle_model.hpp"

namespace stg::dynamics {

World::World(const WorldConfig& scenario) : scenario_(scenario), dt_ns_(scenario.step_period()) {
  config::ValidateOrThrow(scenario_);
  model_ = std::make_unique<VehicleModel>(scenario_.vehicle);
  const auto n = static_cast<size_t>(scenario_.agents);
  const auto m = static_cast<size_t>(scenario_.target.count);
  vehicles_.resize(n);
  contact_.resize(n);
  disturbance_.resize(n);
  distances_.assign(n * n, Pack(0.0));
  targets_.resize(m);
  waypoint_.assign(m * kLanes, 0);
  for (auto& v : vehicles_) {
    v.trig = TrigOf(v.rpy);
    v.R_WB = RotationOf(v.trig);
  }
}

World::~World() = default;
World::World(World&&) noexcept = default;

Navigation<Pack> World::Nav(int i) const {
  const VehicleState<Pack>& v = vehicle(i);
  Navigation<Pack> nav;
  for (int lane = 0; lane < kLanes; ++lane) nav.stamp[static_cast<size_t>(lane)] = time(lane);
  nav.p_WB = v.p_WB;
  nav.v_WB_B = v.v_WB_B;
  nav.w_WB_B = v.w_WB_B;
  if (scenario_.vehicle.integrator == Integrator::kSemiImplicit) {
    QuaternionOf(v.rpy, &nav.q_WB);
  } else {
    std::copy(v.q_WB, v.q_WB + 4, nav.q_WB);
  }
  return nav;
}

NavState World::Nav(int lane, int i) const {
  const Navigation<Pack> all = Nav(i);
  NavState nav;
  nav.stamp = time(lane);
  nav.p_WB = Lane(all.p_WB, lane);
  nav.v_WB_B = Lane(all.v_WB_B, lane);
  nav.w_WB_B = Lane(all.w_WB_B, lane);
  for (int k = 0; k < 4; ++k) nav.q_WB[k] = Lane(all.q_WB[k], lane);
  return nav;
}

void World::Step(const std::vector<Wrench<Pack>>& tau) {
  assert(static_cast<int>(tau.size()) == agents());
  const Vec3<Pack> v_WC{Pack(scenario_.current.velocity_mps[0]),
                        Pack(scenario_.current.velocity_mps[1]),
                        Pack(scenario_.current.velocity_mps[2])};
  AddContacts();
  AddDisturbance();
  for (size_t i = 0; i < vehicles_.size(); ++i) {
    VehicleState<Pack>& s = vehicles_[i];
    Wrench<Pack> total = tau[i];
    if (scenario_.vehicle.float32_tau) {
      for (Pack* x : {&total.force.x, &total.force.y, &total.force.z, &total.moment.x,
                      &total.moment.y, &total.moment.z}) {
        *x = RoundToFloat(*x);
      }
    }
    // The release adds contact to the command before the actuator limits; w of
    // Eq. 3 acts on the hull, so it comes after them.
    total.force += s.R_WB.TransposeTimes(contact_[i]);
    total = model_->Limit(total);
    total.force += disturbance_[i].force;
    total.moment += disturbance_[i].moment;
    Integrate(*model_, total, v_WC, scenario_.time.dt_s, &s);
    ApplyWalls(&s);
  }
  MoveTargets();
  for (auto& step : step_) ++step;
  MeasureDistances();
}

void World::AddContacts() {
  const double reach = 2.0 * scenario_.vehicle.radius_m;
  const double k = scenario_.contact.softness_m;
  for (auto& f : contact_) f = {};
  const int n = agents();
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      const Pack& d = distance(i, j);
      // Beyond 40 softness lengths the softplus is below 1e-17 of a length; cut there lane by
      // lane, so that no lane's result depends on the others.
      const auto near = d < Pack(reach + 40.0 * k);
      if (!Any(near)) continue;
      const Pack x = (Pack(reach) - d) * Pack(1.0 / k);
      const Pack softplus = Max(x, Pack(0.0)) + Log1p(Exp(-Abs(x)));
      const Pack force = Select(near, Pack(scenario_.contact.stiffness * k) * softplus, Pack(0.0));
      const Vec3<Pack> away = (vehicle(i).p_WB - vehicle(j).p_WB) * (force / Max(d, Pack(1e-9)));
      contact_[static_cast<size_t>(i)] += away;
      contact_[static_cast<size_t>(j)] += -away;
    }
  }
}

void World::AddDisturbance() {
  const DisturbanceConfig& c = scenario_.disturbance;
  if (c.force_std_n == 0.0 && c.moment_std_nm == 0.0) return;
  // Exact discretisation of the Gauss-Markov process: stationary at std.
  const double decay = std::exp(-scenario_.time.dt_s / c.correlation_time_s);
  const double drive = std::sqrt(1.0 - decay * decay);
  for (size_t i = 0; i < disturbance_.size(); ++i) {
    Wrench<Pack>& w = disturbance_[i];
    for (int lane = 0; lane < kLanes; ++lane) {
      Random random(seed_[lane], Stream::kDisturbance, episode_[lane], step_[lane],
                    static_cast<std::uint32_t>(i));
      const bool first = step_[lane] == 0;
      const auto next = [&](Pack* x, double std) {
        const double n = random.Normal() * std;
        SetLane(x, lane, first ? n : decay * Lane(*x, lane) + drive * n);
      };
      for (Pack* x : {&w.force.x, &w.force.y, &w.force.z}) next(x, c.force_std_n);
      for (Pack* x : {&w.moment.x, &w.moment.y, &w.moment.z}) next(x, c.moment_std_nm);
    }
  }
}

void World::ApplyWalls(VehicleState<Pack>* s) const {
  const WorkspaceConfig& c = scenario_.workspace;
  const Pack limit(c.half_extent_m), zero(0.0), one(1.0);
  const auto hit_x = Abs(s->p_WB.x) > limit;
  const auto hit_y = Abs(s->p_WB.y) > limit;
  const auto hit_z = Abs(s->p_WB.z) > limit;
  const auto hit = hit_x || hit_y || hit_z;
  if (!Any(hit)) return;
  const Pack tangential(c.tangential);
  const auto reflect = [&](const Pack& p, const Pack& v) {
    // Outward velocity turns back; a vehicle already moving inward keeps it.
    return Select(p * v > zero, -v * Pack(c.restitution), v);
  };
  Vec3<Pack> v = s->v_WB;
  v.x = Select(hit_x, reflect(s->p_WB.x, v.x), v.x);
  v.y = Select(hit_x, v.y * tangential, v.y);
  v.z = Select(hit_x, v.z * tangential, v.z);
  v.y = Select(hit_y, reflect(s->p_WB.y, v.y), v.y);
  v.x = Select(hit_y, v.x * tangential, v.x);
  v.z = Select(hit_y, v.z * tangential, v.z);
  v.z = Select(hit_z, reflect(s->p_WB.z, v.z), v.z);
  v.x = Select(hit_z, v.x * tangential, v.x);
  v.y = Select(hit_z, v.y * tangential, v.y);
  s->v_WB = v;
  s->p_WB = Clip(s->p_WB, -c.half_extent_m, c.half_extent_m);
  s->v_WB_B = s->v_WB_B * Select(hit, Pack(c.body_velocity), one);
  s->w_WB_B = s->w_WB_B * Select(hit, Pack(c.body_rate), one);
}

void World::MeasureDistances() {
  const int n = agents();
  const Pack contact(2.0 * scenario_.vehicle.radius_m);
  colliding_pairs_ = Pack(0.0);
  smallest_separation_ = Pack(1e9);
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      const Pack d = Norm(vehicle(j).p_WB - vehicle(i).p_WB);
      distances_[static_cast<size_t>(i * n + j)] = d;
      distances_[static_cast<size_t>(j * n + i)] = d;
      colliding_pairs_ += Select(d < contact, Pack(1.0), Pack(0.0));
      smallest_separation_ = Min(smallest_separation_, d);
    }
  }
}

}  // namespace stg::dynamics

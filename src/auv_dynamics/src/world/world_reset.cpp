#include <cassert>
#include <cmath>

#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "auv_dynamics/vehicle/vehicle_model.hpp"
#include "auv_dynamics/world/world.hpp"

namespace stg::dynamics {
namespace {

Vec3<double> UniformDirection(Random* random) {
  const double z = random->Uniform(-1.0, 1.0);
  const double angle = random->Uniform(0.0, 2.0 * kPi);
  const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {r * std::cos(angle), r * std::sin(angle), z};
}

bool Inside(const Vec3<double>& p, double half_extent) {
  return std::abs(p.x) <= half_extent && std::abs(p.y) <= half_extent &&
         std::abs(p.z) <= half_extent;
}

}  // namespace

void World::StartLane(int lane, std::uint64_t seed, std::uint32_t episode) {
  seed_[lane] = seed;
  episode_[lane] = episode;
  step_[lane] = 0;
  for (auto& v : vehicles_) {
    SetLane(&v.rpy, lane, {});
    for (int k = 0; k < 4; ++k) SetLane(&v.q_WB[k], lane, k == 0 ? 1.0 : 0.0);
    SetLane(&v.v_WB_B, lane, {});
    SetLane(&v.w_WB_B, lane, {});
    SetLane(&v.v_WB, lane, {});
    const EulerTrig<double> level = TrigOf(Vec3<double>{});
    const Mat3<double> R = RotationOf(level);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) SetLane(&v.R_WB.m[r][c], lane, R.m[r][c]);
    }
    for (Pack* s : {&v.trig.sin_phi, &v.trig.sin_theta, &v.trig.sin_psi}) SetLane(s, lane, 0.0);
    for (Pack* c : {&v.trig.cos_phi, &v.trig.cos_theta, &v.trig.cos_psi}) SetLane(c, lane, 1.0);
  }
  for (int k = 0; k < targets(); ++k) waypoint_[static_cast<size_t>(lane * targets() + k)] = 0;
}

void World::Reset(int lane, std::uint64_t seed, std::uint32_t episode, ResetStage stage) {
  StartLane(lane, seed, episode);
  const ResetConfig& c = scenario_.reset;
  const ResetStageConfig& r = c.stages[static_cast<size_t>(stage)];
  Random random(seed, Stream::kReset, episode, 0, 0);
  for (auto& target : targets_) {
    const double radius = random.Uniform(r.target_radius_m.lo, r.target_radius_m.hi);
    SetLane(&target.p_WT, lane, UniformDirection(&random) * radius);
    const double speed = random.Uniform(r.target_speed_mps.lo, r.target_speed_mps.hi);
    SetLane(&target.v_WT, lane, UniformDirection(&random) * speed);
  }
  for (int i = 0; i < agents(); ++i) {
    const Vec3<double> p_WT = Lane(target(scenario_.target_of(i)).p_WT, lane);
    Vec3<double> p_WB;
    bool placed = false;
    // Rejection sampling; the validator rejects scenarios too crowded for it.
    for (int attempt = 0; attempt < 100000 && !placed; ++attempt) {
      const double d = random.Uniform(r.auv_distance_m.lo, r.auv_distance_m.hi);
      p_WB = p_WT + UniformDirection(&random) * d;
      placed = Inside(p_WB, c.start_half_extent_m);
      for (int j = 0; j < i && placed; ++j) {
        placed = Norm(p_WB - Lane(vehicle(j).p_WB, lane)) >= c.min_separation_m;
      }
    }
    if (!placed) {
      throw UserError("reset: no room for " + std::to_string(agents()) +
                      " vehicles at reset.min_separation_m");
    }
    SetLane(&vehicles_[static_cast<size_t>(i)].p_WB, lane, p_WB);
  }
  separations_.Measure(vehicles_);
}

void World::Place(int lane, const std::vector<Vec3<double>>& p_WB,
                  const std::vector<Vec3<double>>& p_WT, const std::vector<Vec3<double>>& v_WT) {
  assert(static_cast<int>(p_WB.size()) == agents());
  assert(static_cast<int>(p_WT.size()) == targets() && p_WT.size() == v_WT.size());
  StartLane(lane, 0, 0);
  for (size_t i = 0; i < p_WB.size(); ++i) SetLane(&vehicles_[i].p_WB, lane, p_WB[i]);
  for (size_t k = 0; k < p_WT.size(); ++k) {
    SetLane(&targets_[k].p_WT, lane, p_WT[k]);
    SetLane(&targets_[k].v_WT, lane, v_WT[k]);
  }
  separations_.Measure(vehicles_);
}

}  // namespace stg::dynamics

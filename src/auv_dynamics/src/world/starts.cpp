#include "auv_dynamics/world/starts.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/error.hpp"
#include "auv_common/numbers/attitude.hpp"
#include "auv_common/numbers/random.hpp"

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

void DrawStart(const ResetConfig& config, ResetStage stage, std::uint64_t seed,
               std::uint32_t episode, Start* start) {
  const ResetStageConfig& r = config.stages[static_cast<size_t>(stage)];
  Random random(seed, Stream::kReset, episode, 0, 0);
  for (auto& target : start->targets) {
    const double radius = random.Uniform(r.target_radius_m.lo, r.target_radius_m.hi);
    target.p_WT = UniformDirection(&random) * radius;
    const double speed = random.Uniform(r.target_speed_mps.lo, r.target_speed_mps.hi);
    target.v_WT = UniformDirection(&random) * speed;
  }
  auto& p_WB = start->p_WB;
  for (size_t i = 0; i < p_WB.size(); ++i) {
    const Vec3<double>& p_WT = start->targets[i % start->targets.size()].p_WT;
    bool placed = false;
    // Rejection sampling; the validator rejects scenarios too crowded for it.
    for (int attempt = 0; attempt < 100000 && !placed; ++attempt) {
      const double d = random.Uniform(r.auv_distance_m.lo, r.auv_distance_m.hi);
      p_WB[i] = p_WT + UniformDirection(&random) * d;
      placed = Inside(p_WB[i], config.start_half_extent_m);
      for (size_t j = 0; j < i && placed; ++j) {
        placed = Norm(p_WB[i] - p_WB[j]) >= config.min_separation_m;
      }
    }
    if (!placed) {
      throw UserError("reset: no room for " + std::to_string(p_WB.size()) +
                      " vehicles at reset.min_separation_m");
    }
  }
}

}  // namespace stg::dynamics

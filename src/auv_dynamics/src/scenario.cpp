#include "auv_dynamics/scenario.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "auv_dynamics/error.hpp"
#include "scenario_schema.hpp"
#include "scenario_value.hpp"

namespace stg {
namespace {

bool IsWhole(double value) { return std::abs(value - std::round(value)) < 1e-6; }

/// Fossen's M = M_RB + M_A about the body origin.
bool MassMatrixIsPositive(const VehicleConfig& v) {
  Eigen::Matrix<double, 6, 6> m = Eigen::Matrix<double, 6, 6>::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    m(i, i) = v.mass_kg - v.added_mass[k];
    m(i + 3, i + 3) = v.inertia_kgm2[k] - v.added_mass[k + 3];
  }
  const auto [x, y, z] = v.r_BG_m;
  Eigen::Matrix3d s;
  s << 0.0, -z, y, z, 0.0, -x, -y, x, 0.0;
  m.topRightCorner<3, 3>() = -v.mass_kg * s;
  m.bottomLeftCorner<3, 3>() = v.mass_kg * s;
  return m.llt().info() == Eigen::Success;
}

/// Can all AUVs be drawn one after the other with this separation around one
/// point (targets may start together)? The share of the shell's volume that
/// balls of half the separation may fill stays below what random placement
/// reaches (about 0.38).
bool StartsFit(const ResetConfig& reset, const ResetStageConfig& stage, int agents) {
  constexpr double kShare = 0.25;
  const double half = 0.5 * reset.min_separation_m;
  const double outer = stage.auv_distance_m.hi + half;
  const double inner = std::max(0.0, stage.auv_distance_m.lo - half);
  return agents == 1 ||
         agents * half * half * half <= kShare * (outer * outer * outer - inner * inner * inner);
}

std::optional<Violation> CheckStage(const Scenario& s, int index) {
  const char* const names[] = {"easy", "medium", "hard"};
  const std::string path = std::string("reset.stages.") + names[index] + ".";
  const ResetStageConfig& stage = s.reset.stages[static_cast<std::size_t>(index)];
  if (stage.target_radius_m.hi > s.workspace.half_extent_m) {
    return Violation{{path + "target_radius_m", "workspace.half_extent_m"},
                     "a target would start outside the walls"};
  }
  if (stage.target_speed_mps.hi > s.target.max_speed_mps) {
    return Violation{{path + "target_speed_mps", "target.max_speed_mps"},
                     "a target would start faster than its largest speed"};
  }
  if (stage.auv_distance_m.lo > s.reset.start_half_extent_m) {
    return Violation{{path + "auv_distance_m", "reset.start_half_extent_m"},
                     "AUVs cannot start this far from a target within the start region"};
  }
  const bool used = s.reset.curriculum || static_cast<int>(s.reset.stage) == index;
  if (used && !StartsFit(s.reset, stage, s.agents)) {
    return Violation{{"agents", path + "auv_distance_m", "reset.min_separation_m"},
                     "so many AUVs do not fit around a target with this separation"};
  }
  return {};
}

std::optional<Violation> CheckRules(const Scenario& s) {
  if (!IsWhole(s.time.dt_s * 1e9)) {
    return Violation{{"time.dt_s"}, "must be a whole number of nanoseconds"};
  }
  if (s.time.tail_steps > s.time.episode_steps) {
    return Violation{{"time.tail_steps", "time.episode_steps"},
                     "the tail cannot be longer than the episode"};
  }
  if (!MassMatrixIsPositive(s.vehicle)) {
    return Violation{{"vehicle.r_BG_m", "vehicle.inertia_kgm2"},
                     "the mass matrix is not positive definite"};
  }
  if (s.vehicle.radius_m >= s.workspace.half_extent_m) {
    return Violation{{"vehicle.radius_m", "workspace.half_extent_m"},
                     "an AUV does not fit between the walls"};
  }
  if (s.target.count > s.agents) {
    return Violation{{"target.count", "agents"}, "there cannot be more targets than AUVs"};
  }
  if (s.reset.start_half_extent_m > s.workspace.half_extent_m) {
    return Violation{{"reset.start_half_extent_m", "workspace.half_extent_m"},
                     "AUVs would start outside the walls"};
  }
  if (s.reset.curriculum_medium_resets < s.reset.curriculum_easy_resets) {
    return Violation{{"reset.curriculum_medium_resets", "reset.curriculum_easy_resets"},
                     "the medium stage cannot end before the easy one"};
  }
  for (int i = 0; i < 3; ++i) {
    if (auto violation = CheckStage(s, i)) return violation;
  }
  if (s.channel.transmit_period_s < s.decision_dt_s() * (1.0 - 1e-9)) {
    return Violation{{"channel.transmit_period_s", "time.dt_s", "time.decision_steps"},
                     "an AUV sends at most one packet per decision"};
  }
  if (s.observation.quality_medium > s.observation.quality_high) {
    return Violation{{"observation.quality_medium", "observation.quality_high"},
                     "medium quality cannot begin above high quality"};
  }
  if (s.reward.lost_distance_m <= s.reward.band_m.hi) {
    return Violation{{"reward.lost_distance_m", "reward.band_m"},
                     "a target inside the tracking band would count as lost"};
  }
  if (s.reward.weights.separation > 0.0 &&
      s.reward.separation_distance_m <= 2.0 * s.vehicle.radius_m) {
    return Violation{{"reward.separation_distance_m", "vehicle.radius_m"},
                     "the penalty must set in before contact, at two radii"};
  }
  return {};
}

}  // namespace

std::optional<Violation> FindViolation(const Scenario& scenario) {
  Scenario copy = scenario;
  for (const ScenarioField& field : ScenarioFields(&copy)) {
    if (auto message = CheckValue(field)) return Violation{{field.path}, *message};
  }
  return CheckRules(copy);
}

void Scenario::ValidateOrThrow() const {
  const auto violation = FindViolation(*this);
  if (!violation) return;
  std::string text = "scenario: " + violation->keys[0] + ": " + violation->message;
  for (std::size_t i = 1; i < violation->keys.size(); ++i) {
    text += (i == 1 ? " (see " : ", ") + violation->keys[i];
  }
  throw UserError(text + (violation->keys.size() > 1 ? ")" : ""));
}

}  // namespace stg

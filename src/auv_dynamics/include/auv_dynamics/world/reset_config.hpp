#pragma once

#include <array>

#include "auv_common/config/field.hpp"

namespace stg::dynamics {

/// Stages of the curriculum: distance and speed of targets at the start.
enum class ResetStage { kEasy, kMedium, kHard };

/// Start of vehicles: each around its target, or all on a line in one place, or anywhere. In the
/// first case, their positions contain information about the target.
enum class Deploy { kAround, kPoint, kArea };

/// Ranges of start positions and speeds.
struct ResetStageConfig {
  config::Interval target_radius_m{0.25, 0.55};
  config::Interval auv_distance_m{0.25, 0.45};
  config::Interval target_speed_mps{0.003, 0.008};
};

/// How episodes start; stages are in the order easy, medium, hard.
struct ResetConfig {
  ResetStage stage = ResetStage::kMedium;  ///< evaluation and fixed training
  Deploy deploy = Deploy::kAround;
  bool curriculum = false;  ///< training: easy, medium, hard by reset count
  int curriculum_easy_resets = 800;
  int curriculum_medium_resets = 2000;
  double min_separation_m = 0.10;
  double start_half_extent_m = 0.9;
  std::array<ResetStageConfig, 3> stages{{
      {{0.05, 0.20}, {0.08, 0.20}, {0.001, 0.004}},
      {{0.25, 0.55}, {0.25, 0.45}, {0.003, 0.008}},
      {{0.45, 0.75}, {0.40, 0.70}, {0.006, 0.014}},
  }};
};

/// Keys, units and ranges of the section.
void Describe(ResetConfig* c, config::Table* t);

}  // namespace stg::dynamics

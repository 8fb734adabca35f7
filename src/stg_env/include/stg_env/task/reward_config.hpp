#pragma once

#include <map>
#include <string>

#include "auv_common/config/options.hpp"

namespace stg::task {

/// The paper's reward (Eqs. 28-36), the release's reward, and the release's reward for its
/// baselines without a task graph.
enum class RewardKind { kPaper, kRelease, kReleaseRaw };

/// Weights of the terms of Eq. 36, and of our separation term.
struct RewardWeights {
  double tracking = 0.72, observation = 0.16, coordination = 0.02, communication = 0.01,
         semantic = 0.09, control_cost = 0.08, separation = 0.0;
};

/// Constants of the reward, Eqs. 28-36, and of our separation term.
struct RewardConfig {
  RewardKind kind = RewardKind::kPaper;
  RewardWeights weights;
  config::Interval band_m{0.010, 0.015};  ///< [d_l, d_u]
  double error_max_m = 0.8;               ///< e_max
  double w_band = 0.35, w_progress = 0.30, w_closing = 0.15, w_reacquire = 0.20,
         w_too_close = 0.20;             ///< Eq. 30
  double separation_distance_m = 0.024;  ///< separation reward: 0 beyond, -1 at contact centres
  /// Weights of registered terms by name (reward_term.hpp); one of weight 0 is not evaluated.
  std::map<std::string, double> terms;
  config::OptionsByName term_options = {};
  double total_limit = 2.0;
};

/// Keys, units and ranges of the section.
void Describe(RewardConfig* c, config::Table* t);

}  // namespace stg::task

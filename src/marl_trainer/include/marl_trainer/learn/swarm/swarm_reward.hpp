#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "marl_trainer/learn/swarm/swarm_config.hpp"

namespace stg::learn {

/// Reward of a decision of one AUV in the band of a target with `inside` AUVs, as a share of the
/// reward of an AUV alone. For targets that are chosen freely, two AUVs are enough, because two
/// ranges locate the target; more AUVs share the reward of two.
double ShareOfBand(bool chosen, int inside);
/// Reward of such a decision for all AUVs: min(inside, 2) / 2, as the mean over the targets. @param
/// inside number of AUVs in the band of each target
double ShareCovered(const std::vector<int>& inside);

/// What a reward depends on, of one AUV after a decision.
struct Outcome {
  float reward = 0.0F;      ///< by the scenario that is trained with
  double distance_m = 0.0;  ///< true distance to its target
  double error_m = 0.0;     ///< |distance - desired distance|
  int followed = 0;         ///< the target that it follows
  bool present = true;      ///< false: it has left the swarm
};

/// The reward of learning with swarms, for environments and for recordings. Arrays have one entry
/// for each AUV of one swarm.
class SwarmReward {
 public:
  SwarmReward(const SwarmConfig& config, const task::JudgeConfig& scenario);

  /// Adds the reward of one decision: that of the scenario, and that of the band.
  void Add(const Outcome* outcomes, float* sums) const;
  /// Phi of the shaping.
  double Potential(const Outcome& outcome) const;
  /// The reward of a command: the own mean reward, the mean of the team, and the shaping.
  /// @param own mean of Add over the decisions of the command
  /// @param absent 1: the AUV had left, and is not part of the team
  /// @param before, after potentials at its begin and at its end
  void Share(const float* own, const std::uint8_t* absent, const float* before, const float* after,
             float* rewards) const;

 private:
  bool SameTeam(int i, int j) const;

  int agents_, targets_count_;
  bool free_;  // AUVs that choose their targets share all of them
  config::Interval band_m_;
  dynamics::TargetConfig targets_;
  double band_, shaping_;
  float own_share_, gamma_;
};

/// Changes of a scenario for a training with swarms, "key.path=value": rewards are given near the
/// band, and the shaping covers the way to it.
const std::vector<std::string>& SwarmRewardKeys();

}  // namespace stg::learn

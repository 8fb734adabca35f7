#include <cassert>

#include "env_internal.hpp"

namespace stg::env {

void EnvGroup::FollowStart(const FollowedSwarm& swarm) {
  assert(!acoustic_);
  world_.Follow(swarm.vehicles, swarm.targets);
  followed_quality_ = Pack(swarm.link_quality);
  episode_steps_ = scenario_.time.episode_steps;
  truncated_ = false;
  BeginSemantics();
}

void EnvGroup::FollowStep(const FollowedSwarm& swarm) {
  assert(!acoustic_ && followed_quality_);
  previous_action_ = action_;
  previous_tau_ = tau_;
  for (size_t i = 0; i < truth_.size(); ++i) {
    for (size_t k = 0; k < 6; ++k) {
      tau_[i][k] = Pack(swarm.fractions[i][k]);
      action_[i][k] = Pack(swarm.actions[i][k]);
    }
  }
  world_.Follow(swarm.vehicles, swarm.targets);
  followed_quality_ = Pack(swarm.link_quality);
  ++step_;
  Measure(false);
  ComputeRewards();
  WriteStates();
  truncated_ = step_ >= episode_steps_;
  if (!truncated_) return;
  final_states_ = states_;
  for (int lane = 0; lane < kLanes; ++lane) {
    finished_[static_cast<size_t>(lane)] = totals_->Metrics(lane);
  }
}

task::EpisodeMetrics EnvGroup::MetricsSoFar(int lane) const { return totals_->Metrics(lane); }

}  // namespace stg::env

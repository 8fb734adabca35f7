#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "marl_trainer/learn/swarm/recorded_swarm_trainer.hpp"
#include "online_learner.hpp"
#include "swarm_inlet.hpp"

namespace stg::nodes {

/// Learns with a network over entities: from EntityStep, TaskState and SwarmState, by
/// RecordedSwarmTrainer. It does not read bags.
class EntityLearner : public OnlineLearner {
 public:
  EntityLearner(const Scenario& scenario, const learn::SwarmConfig& config,
                const learn::SwarmStart& start, const learn::RecordedSwarmTrainer::Options& options)
      : trainer_(scenario, config, start, options) {
    Restart();
  }

  std::vector<ros::Subscriber> Subscribe(const Hooks& hooks) override;
  void Restart() override {
    inlet_ = std::make_unique<SwarmInlet>(trainer_.scenario().judge(), "live");
  }
  std::vector<Episode> TakeDone() override;
  Bag ReadBag(const std::string& path) override;
  learn::RecordedTrainer::Progress Update() override {
    return trainer_.Update(std::exchange(kept_, {}));
  }

  const std::string& policy_id() const override { return trainer_.policy_id(); }
  std::string policy_path() const override { return trainer_.policy_path(); }
  std::int64_t updates() const override { return trainer_.updates(); }
  std::int64_t env_steps() const override { return trainer_.env_steps(); }

 private:
  learn::RecordedSwarmTrainer trainer_;
  std::unique_ptr<SwarmInlet> inlet_;
  std::vector<learn::SwarmEpisode> kept_;
};

}  // namespace stg::nodes

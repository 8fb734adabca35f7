#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../record_inlet.hpp"
#include "online_learner.hpp"

namespace stg::nodes {

/// Learns with an observation vector: from AgentStep and StepReport, by RecordedTrainer.
class LayersLearner : public OnlineLearner {
 public:
  LayersLearner(const Scenario& scenario, const learn::TrainSetup& setup,
                const learn::RecordedTrainer::Options& options)
      : scenario_(scenario), trainer_(scenario, setup, options) {
    Restart();
  }

  std::vector<ros::Subscriber> Subscribe(const Hooks& hooks) override;
  void Restart() override { inlet_ = std::make_unique<RecordInlet>(scenario_.run, "live"); }
  std::vector<Episode> TakeDone() override { return Judge(inlet_->episodes().TakeDone()); }
  Bag ReadBag(const std::string& path) override;
  learn::RecordedTrainer::Progress Update() override;

  const std::string& policy_id() const override { return trainer_.policy_id(); }
  std::string policy_path() const override { return trainer_.policy_path(); }
  std::int64_t updates() const override { return trainer_.updates(); }
  std::int64_t env_steps() const override { return trainer_.env_steps(); }

 private:
  /// Keeps the good episodes.
  std::vector<Episode> Judge(std::vector<learn::RecordedEpisode> episodes);

  const Scenario scenario_;
  learn::RecordedTrainer trainer_;
  std::unique_ptr<RecordInlet> inlet_;
  std::vector<learn::RecordedEpisode> kept_;
};

}  // namespace stg::nodes

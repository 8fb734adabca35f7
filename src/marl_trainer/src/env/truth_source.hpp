#pragma once

#include <vector>

#include "information_source.hpp"
#include "marl_trainer/scenario/scenario.hpp"

namespace stg::env {

/// Everybody knows the true states of all: the paper's formulas, as its release computes them.
class TruthSource : public InformationSource {
 public:
  explicit TruthSource(const Scenario& scenario);

  void Start(const dynamics::World& world, const LaneSet& lanes) override;
  void Observe(const dynamics::World& world, const LaneSet& lanes) override;
  void Act(const dynamics::World& world, int i, const Pack* wanted, std::array<Pack, 6>* action,
           std::array<Pack, 6>* tau) override;
  void Send(const dynamics::World&) override {}
  const agent::Knowledge<Pack>& knowledge(int i) const override {
    return truth_[static_cast<std::size_t>(i)];
  }
  Pack LinkQuality(const dynamics::World& world) const override;

 private:
  void Measure(const dynamics::World& world, bool first);
  Pack MeanError(size_t i, const Pack& error);
  void NeighbourFeatures(const dynamics::World& world, int i, agent::Knowledge<Pack>* k) const;

  Scenario scenario_;
  std::vector<agent::Knowledge<Pack>> truth_;
  std::vector<std::vector<Pack>> error_window_;
  int step_ = 0;
  bool first_ = true;
};

}  // namespace stg::env

#pragma once

#include <vector>

#include "information_source.hpp"
#include "stg_agent/agent/mind.hpp"

namespace stg::env {

/// All AUVs know all true states: the paper's formulas, as its release computes them. It uses the
/// same class Mind as the agents, with true states as input.
class TruthSource : public InformationSource {
 public:
  /// @param range_m true range of links; the model may have another one
  TruthSource(const agent::AgentModel& model, double range_m);

  void Start(const dynamics::World& world, const LaneSet& lanes) override;
  void Observe(const dynamics::World& world, const LaneSet& lanes) override;
  void Act(const dynamics::World& world, int i, const Pack* wanted, task::Effort<Pack>* action,
           task::Effort<Pack>* tau) override;
  void Send(const dynamics::World&) override {}
  const agent::Knowledge<Pack>& knowledge(int i) const override {
    return minds_[static_cast<std::size_t>(i)].knowledge;
  }
  Pack LinkQuality(const dynamics::World& world) const override;
  void Tell(const dynamics::World& world, int i, task::FieldState<Pack>* state) const override;

 private:
  void Think(const dynamics::World& world);
  /// Writes quality and number of all AUVs' links to links_.
  void MeasureLinks(const dynamics::World& world);
  void Show(const dynamics::World& world, int i, Vec3<Pack>* slots) const;

  agent::AgentModel model_;
  double range_m_;
  bool exact_angles_;                              // the integrator keeps roll, pitch and yaw
  std::vector<agent::Mind<Pack>> minds_;           // [agent]
  std::vector<agent::Mind<Pack>> before_;          // minds_ before the present Observe
  std::vector<agent::NeighbourView<Pack>> links_;  // [agent], of the present Think
};

}  // namespace stg::env

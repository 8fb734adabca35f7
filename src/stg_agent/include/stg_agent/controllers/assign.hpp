#pragma once

#include <memory>

#include "stg_agent/controllers/encircle.hpp"
#include "stg_agent/controllers/formation.hpp"

/// The controller `assign`: chooses the target to follow, and circles it or keeps a place in a ring
/// around it.
namespace stg::agent {

/// Constants of the law.
struct AssignOptions {
  double load_s = 100.0;       ///< added cost of a target for each AUV beyond `least`
  double extra = 0.2;          ///< share of the way that counts for an AUV beyond `least`
  double hysteresis_s = 60.0;  ///< shortest time with a target, and gain of a change
  int least = 2;               ///< number of AUVs that each target should have
  double period_s = 5.0;       ///< time between two choices
  double silent_frames = 2.5;  ///< an AUV that has been silent for so many counts as gone
  double fast_mps = 2.3;       ///< largest speed over ground
  double form = 0.0;           ///< 0: circle, as `encircle`; 1: keep a place, as `formation`
};

void Describe(AssignOptions* o, config::Table* t);

/// Each AUV assigns targets to all AUVs that it knows, at the least total cost. The cost of an AUV
/// is its time to the target's circle, max(0, d - d*) / (v_max - v_T), plus a load; a target that
/// an AUV follows already is cheaper by `hysteresis`. No target gets more than `least` AUVs before
/// each target has so many. The way of an AUV beyond that counts less, because the target is
/// followed before it arrives. No target gets more than ceil(AUVs / targets) + 1. All AUVs use the
/// same packets, so they find the same assignment, except where packets were lost. The Hungarian
/// method solves it.
///
/// With task.assignment modulo, and with true states, the AUV follows its assigned target.
class Assign final : public Controller {
 public:
  explicit Assign(const AssignOptions& options);

  void Act(const ControllerInput<double>& input, double* action) const override;
  void Act(const ControllerInput<Pack>& input, Pack* action) const override;
  /// Chooses a target when `period` is over; the choice holds from the next decision on.
  void Act(const AgentView& agent, float* action) const override;

  /// Chooses a target when `period` is over, as Act does.
  void ChooseWhenDue(const AgentView& agent) const;
  /// The target that the AUV should follow, from its present knowledge.
  int Choose(const AgentView& agent) const;

 private:
  template <class T>
  void Follow(const ControllerInput<T>& input, T* action) const;

  AssignOptions o_;
  Encircle circle_;
  Formation form_;
};

std::unique_ptr<Controller> MakeAssign(const AssignOptions& options);

}  // namespace stg::agent

#pragma once

#include <memory>

#include "stg_agent/controllers/encircle.hpp"
#include "stg_agent/controllers/formation.hpp"

/// The controller `assign`: chooses which target to follow, and then circles it or keeps a place at
/// it.
namespace stg::agent {

/// Constants of the law.
struct AssignOptions {
  double load_s = 100.0;       ///< what each AUV beyond `least` at a target costs more
  double hysteresis_s = 60.0;  ///< another target must be better by this; so long it keeps one
  int least = 2;               ///< AUVs that every target should have
  double period_s = 5.0;       ///< between two choices
  double silent_frames = 2.5;  ///< an AUV that is silent for so many is taken to be gone
  double fast_mps = 2.3;       ///< over ground, at most
  double form = 0.0;           ///< 0: circles as `encircle`; 1: keeps a place as `formation`
};

void Describe(AssignOptions* o, config::Table* t);

/// Every AUV solves for the whole swarm, as far as it knows it: which one follows which target at
/// the least cost, the sum over AUVs of the time to the target's circle, max(0, d - d*) / (v_max -
/// v_T), and of a load. Every target has AUVs up to `least` before another one has more, and no
/// more than the number of AUVs by that of targets, rounded up, and one. All AUVs start from the
/// same packets, so that they come to the same result up to what got lost on the way; what others
/// say that they follow, and what it follows itself, counts as cheaper by `hysteresis`. Solved by
/// the Hungarian method.
///
/// Where targets are not chosen freely (task.assignment), and with true states, it follows the
/// target that it is tasked with.
class Assign final : public Controller {
 public:
  explicit Assign(const AssignOptions& options);

  void Act(const ControllerInput<double>& input, double* action) const override;
  void Act(const ControllerInput<Pack>& input, Pack* action) const override;
  /// Chooses when it is time to; the choice counts from the next decision on.
  void Act(const AgentView& agent, float* action) const override;

  /// The target that the AUV should follow by what it knows now.
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

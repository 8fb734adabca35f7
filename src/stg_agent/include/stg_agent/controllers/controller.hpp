#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "auv_common/registry.hpp"
#include "auv_dynamics/control/control.hpp"
#include "stg_agent/agent/agent_view.hpp"
#include "stg_agent/agent_config.hpp"
#include "stg_agent/graph/knowledge.hpp"
#include "stg_agent/graph/neighbourhood.hpp"

/// Built-in controllers, with which policies are compared. Each one is a file of its own and a line
/// in the registry (controllers/registry.cpp).
namespace stg::agent {

/// What a controller may read of one AUV (T = double), or of the same AUV in kLanes environments
/// (T = Pack). The caller decides whether it contains the AUV's estimates or true states.
template <class T>
struct ControllerInput {
  const AgentModel& model;
  int id;
  const Knowledge<T>& knowledge;
  const NeighbourSight<T>*
      neighbours;  ///< [neighbour_count], the known ones, in the caller's order
  int neighbour_count;
};

/// Computes an AUV's action from its knowledge. It has no memory of its own, so one object serves
/// all AUVs and any number of threads.
class Controller {
 public:
  virtual ~Controller() = default;

  /// Writes the action, [action_size] numbers in [-1, 1]. Allocates nothing.
  virtual void Act(const ControllerInput<double>& input, double* action) const = 0;
  virtual void Act(const ControllerInput<Pack>& input, Pack* action) const = 0;

  /// The same from an agent's own knowledge after Observe, with its kNearestKnown nearest
  /// neighbours, nearest first; rounded to float, as a policy's action is. A search law reads more
  /// of the agent than a ControllerInput holds, and stores its plan in the agent.
  virtual void Act(const AgentView& agent, float* action) const;
};

/// The input of a law from an agent's own knowledge and its nearest neighbours. It refers to both.
inline ControllerInput<double> InputOf(const AgentView& agent, const NearestSights& nearest) {
  return {agent.model(), agent.id(), agent.knowledge(), nearest.begin(), nearest.size()};
}

/// The controller that a law makes: a copyable class with
///   template <class T> void Act(const ControllerInput<T>& input, T* action) const;
template <class Law>
class ControllerOf final : public Controller {
 public:
  explicit ControllerOf(Law law) : law_(std::move(law)) {}
  void Act(const ControllerInput<double>& input, double* action) const override {
    law_.Act(input, action);
  }
  void Act(const ControllerInput<Pack>& input, Pack* action) const override {
    law_.Act(input, action);
  }
  using Controller::Act;
  const Law& law() const { return law_; }

 private:
  Law law_;
};

/// Writes the action for a desired velocity v in the scenario's interface: v / v_max, or the force
/// of the velocity controller.
/// @param velocity [3] v / v_max, world axes, each in [-1, 1]
template <class T>
inline void AskForVelocity(const ControllerInput<T>& input, const T* velocity, T* action) {
  const AgentModel& s = input.model;
  const Knowledge<T>& k = input.knowledge;
  dynamics::ActionForVelocity(
      s.control, s.vehicle, velocity, k.R_WB, k.v_WB, [&k] { return RpyOf(k.trig); }, k.w_WB_B,
      action);
}

/// All controllers by name; a program may add its own when it starts. A controller's options are
/// its constants, which follow its name: "pursuit:gain=2,cap=0.5".
using ControllerRegistry = Registry<Controller>;
ControllerRegistry& Controllers();
/// Name of the controller that is used where neither policy nor controller is named.
std::string DefaultController();
/// Name of the controller of agents that wait for the first policy of a trainer.
std::string WaitingController();

/// The controller of a name alone or with constants that differ from the tuned ones, as in
/// "pursuit_separated:gain=2,cap=0.5"; null when no controller has that name. Throws UserError for
/// an unknown constant, or one that is not a number in range.
std::shared_ptr<const Controller> MakeController(const std::string& text);

/// Throws UserError, with the controllers' names, for text that is neither a controller nor has the
/// ending of a policy file.
void RequirePolicyFileName(const std::string& text);

}  // namespace stg::agent

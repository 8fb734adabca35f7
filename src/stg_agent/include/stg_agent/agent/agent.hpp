#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stg_agent/agent/agent_lanes.hpp"
#include "stg_agent/graph/observation.hpp"

namespace stg::agent {

/// What an agent decides at one step.
struct AgentOutput {
  /// velocity3: desired velocity, world axes [m/s]. tau6: zero.
  Vec3<double> cmd_vel_W;
  /// tau / tau_max. tau6: the command itself. velocity3: the output of the velocity controller for
  /// cmd_vel_W and the same NavState, bit for bit; a runner without a controller may apply it
  /// through ScaleWrench. Zero where an autopilot steers.
  double fraction[dynamics::kWrenchSize] = {};
  /// Executed action in [-1, 1]: after rate limit and smoothing (velocity3), or clipped
  /// (tau6). Only the first action_size() entries are used.
  double action[dynamics::kMaxActionSize] = {};
};

/// The agent of one AUV in the mode `acoustic`. It makes the observation from its own navigation,
/// its own detections and received packets. It makes the command from the policy's action, and it
/// writes the packet for its modem. It has no other information about the world.
///
/// For every decision, call Receive and Detect in any order, which does not change the result, then
/// Observe, Act and MakePacket. It is deterministic and allocates nothing after construction.
///
/// Conventions that the paper leaves open:
/// - Confidence (Eq. 13) is that of the estimated distance. It is 0 while the track is lost, and
///   while every observation, own or shared, is too old for the link estimator. A cue is not an
///   observation.
/// - Lost: position std above track.lost_std_m, or estimated distance above
///   task.lost_distance_m.
/// - A neighbour without a received packet has quality 0 in the mean link quality. No other
///   average contains it.
class Agent {
 public:
  /// Throws UserError when the model does not fit the packet layout.
  Agent(const AgentModel& model, int id);
  /// An agent that shares model and tables with others.
  Agent(const SharedConstants& constants, int id) : one_(constants, id) {}

  /// Starts an episode and forgets everything. The cue was true at time 0; the later the first
  /// Observe is, the more uncertain the cue has become.
  void Reset(std::uint32_t episode, const dynamics::Cue& cue) { one_.Reset(0, episode, cue); }

  /// Adds a cue of another target, after Reset.
  void AddCue(const dynamics::Cue& cue) { one_.AddCue(0, cue); }

  /// Takes an own detection. Observe uses the newest one. The agent ignores a detection of a target
  /// that it does not estimate.
  void Detect(const dynamics::Detection& detection) { one_.Detect(0, detection); }

  /// Takes a packet that the modem received. A packet that cannot be decoded is counted and
  /// ignored.
  void Receive(const acoustics::Reception& reception) { one_.Receive(0, reception); }

  /// Brings all knowledge to nav.stamp and writes the observation.
  /// @param observation [observation_size()], finite.
  /// Throws std::invalid_argument for a non-finite navigation state: a bug of the caller.
  void Observe(const dynamics::NavState& nav, float* observation);

  /// Executes an action (Eqs. 23-27), once after each Observe.
  /// @param action [action_size()], clipped to [-1, 1] inside. Non-finite values throw
  /// std::invalid_argument.
  AgentOutput Act(const float* action);
  /// The packet for the modem: own state and target estimate at the last Observe.
  Packet MakePacket() const { return one_.MakePacket(0); }

  /// False: the AUV has left the swarm by the last Observe, and sends no packet.
  bool present() const { return one_.present(0); }

  int id() const { return one_.id(); }
  const AgentModel& model() const { return one_.model(); }
  std::uint32_t episode() const { return one_.inbox(0).episode(); }
  /// Number of the last Observe, counted from 0 since Reset.
  std::uint32_t step() const { return static_cast<std::uint32_t>(one_.decisions(0) - 1); }

  /// State of knowledge of the last Observe.
  const Knowledge<double>& knowledge() const { return one_.knowledge(); }
  TaskView task() const { return TaskOf(model().observation, knowledge()); }
  const NeighbourTable& neighbours() const { return one_.neighbours(0); }
  TargetEstimate estimate() const { return one_.inbox(0).estimate(); }
  TargetBelief belief() const { return one_.inbox(0).belief(); }
  /// Index of the target that this agent follows.
  int target() const { return one_.inbox(0).target(); }
  bool lost() const { return knowledge().lost > 0.5; }
  /// All knowledge of the agent.
  AgentView view() const { return one_.view(0); }

 private:
  LanedAgent<double> one_;
};

/// Agents 0 .. run.agents - 1, which share one copy of the model.
std::vector<Agent> MakeAgents(const AgentModel& model);

}  // namespace stg::agent

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
  /// tau / tau_max. tau6: the command itself. velocity3: what the velocity controller
  /// makes of cmd_vel_W and the same NavState, bit for bit; a runner that has no
  /// controller of its own may apply it through ScaleWrench. Zero where an autopilot steers.
  double fraction[dynamics::kWrenchSize] = {};
  /// Executed action in [-1, 1]: after rate limit and smoothing (velocity3), or clipped
  /// (tau6). The first action_size() entries count.
  double action[dynamics::kMaxActionSize] = {};
};

/// One AUV's mind in `acoustic` mode: from own navigation, own detections and received
/// packets to the observation; from the policy's action to the command, and to the packet that it
/// offers to its modem. Knows nothing else of the world.
///
/// Use, for every decision k: Receive and Detect in any order (the result does not depend
/// on it), Observe, Act, MakePacket. Deterministic; allocates nothing after construction.
///
/// Conventions that the paper leaves open:
/// - Confidence (Eq. 13) is that of the estimated distance while the track is not lost and
///   rests on an observation, own or shared, current as the link estimator says; else 0.
///   The cue is no observation.
/// - Lost: position std above track.lost_std_m, or estimated distance above
///   task.lost_distance_m.
/// - A neighbour not heard of counts as link quality 0 in the mean, and in no other average.
class Agent {
 public:
  /// Throws UserError when the scenario does not fit the packet layout.
  Agent(const AgentModel& model, int id);
  /// An agent that shares scenario and tables with others.
  Agent(const SharedConstants& constants, int id) : one_(constants, id) {}

  /// Starts an episode: forgets everything. The cue was true at time 0, whenever the first
  /// Observe is: one that comes late finds it as uncertain as it has become.
  void Reset(std::uint32_t episode, const dynamics::Cue& cue) { one_.Reset(0, episode, cue); }

  /// A cue of another target, likewise, after Reset.
  void AddCue(const dynamics::Cue& cue) { one_.AddCue(0, cue); }

  /// Own detection; of a target that it keeps no belief of: ignored. The newest before the
  /// next Observe counts.
  void Detect(const dynamics::Detection& detection) { one_.Detect(0, detection); }

  /// A packet that the modem gave. One that does not decode is counted and ignored.
  void Receive(const acoustics::Reception& reception) { one_.Receive(0, reception); }

  /// Brings all knowledge to nav.stamp and writes the observation.
  /// @param observation [observation_size()], finite.
  /// Throws std::invalid_argument for a non-finite navigation state: a bug of the caller.
  void Observe(const dynamics::NavState& nav, float* observation);

  /// Executes an action (Eqs. 23-27), once after each Observe.
  /// @param action [action_size()], clipped to [-1, 1] inside. Non-finite values throw
  /// std::invalid_argument.
  AgentOutput Act(const float* action);
  /// Own state and target estimate at the last Observe: what it offers to its modem.
  Packet MakePacket() const { return one_.MakePacket(0); }

  /// False: it has left the swarm, as of the last Observe, and offers no packet.
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
  /// Target this agent is tasked with, or follows.
  int target() const { return one_.inbox(0).target(); }
  bool lost() const { return knowledge().lost > 0.5; }
  /// All that it knows.
  AgentView view() const { return one_.view(0); }

 private:
  LanedAgent<double> one_;
};

/// Agents 0 .. scenario.agents - 1, sharing one copy of the scenario.
std::vector<Agent> MakeAgents(const AgentModel& model);

}  // namespace stg::agent

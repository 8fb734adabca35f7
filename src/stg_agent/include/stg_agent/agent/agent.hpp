#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "auv_dynamics/measurements.hpp"
#include "stg_agent/agent/agent_config.hpp"
#include "stg_agent/agent/mind.hpp"
#include "stg_agent/graph/observation.hpp"
#include "stg_agent/inbox/neighbour_table.hpp"
#include "stg_agent/inbox/target_track.hpp"
#include "stg_agent/packet/packet.hpp"

namespace stg::agent {

/// What an agent decides at one step.
struct AgentOutput {
  /// velocity3: desired velocity, world axes [m/s]. tau6: zero.
  Vec3<double> cmd_vel_W;
  /// tau / tau_max. tau6: the command itself. velocity3: what the velocity controller
  /// makes of cmd_vel_W and the same NavState, bit for bit; a runner that has no
  /// controller of its own may apply it through ScaleWrench.
  double fraction[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  /// Executed action in [-1, 1]: after rate limit and smoothing (velocity3), or clipped
  /// (tau6). The first action_size() entries count.
  double action[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
};

/// The semantic state of one decision, as the policy sees it (Eqs. 14-19).
struct TaskView {
  std::array<double, 8> z_track;
  int phase;    ///< Phase
  int quality;  ///< Quality
  std::array<double, 6> graph;
  bool role;
};

/// One AUV's mind in `acoustic` mode: from own navigation, own detections and received
/// packets to the observation; from the policy's action to the command, and to the packet that it
/// offers to its modem. Knows nothing else of the world.
///
/// Use, for every decision k: Receive and Detect in any order (the result does not depend
/// on it), Observe, Act. Deterministic; allocates nothing after construction. Copies share
/// the scenario.
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
  Agent(const AgentConfig& scenario, int id);
  /// The same mind for AUV `id`, sharing the scenario and tables of `other`; starts reset.
  Agent(const Agent& other, int id);

  /// Starts an episode: forgets everything. The cue was true at time 0, whenever the first
  /// Observe is: one that comes late finds it as uncertain as it has become.
  void Reset(std::uint32_t episode, const dynamics::Cue& cue);

  /// Own detection; of another target than this agent's: ignored. The newest before the
  /// next Observe counts.
  void Detect(const dynamics::Detection& detection);

  /// A packet that the modem gave. One that does not decode is counted and ignored.
  void Receive(const acoustics::Reception& reception);

  /// Brings all knowledge to nav.stamp and writes the observation.
  /// @param observation [observation_size()], finite.
  /// Throws std::invalid_argument for a non-finite navigation state: a bug of the caller.
  void Observe(const dynamics::NavState& nav, float* observation);

  /// Executes an action (Eqs. 23-27), once after each Observe.
  /// @param action [action_size()], clipped to [-1, 1] inside. Non-finite values throw
  /// std::invalid_argument.
  AgentOutput Act(const float* action);
  /// Own state and target estimate at the last Observe, after Act: what it offers to its modem.
  Packet MakePacket() const;

  int id() const { return id_; }
  const AgentConfig& scenario() const { return constants_->scenario; }
  std::uint32_t episode() const { return episode_; }
  /// Number of the last Observe, counted from 0 since Reset.
  std::uint32_t step() const { return step_; }

  /// State of knowledge of the last Observe.
  const Knowledge<double>& knowledge() const { return mind_.knowledge; }
  TaskView task() const;
  const NeighbourTable& neighbours() const { return neighbours_; }
  const TargetTrack& track() const { return track_; }
  /// Target this agent is tasked with.
  int target() const { return target_; }
  bool lost() const { return knowledge().lost > 0.5; }
  /// Smoothed action of the last Act; action_size() entries count.
  const std::array<double, 6>& action() const { return mind_.action; }
  /// Packets of this episode that did not decode.
  std::uint64_t refused_packets() const { return refused_packets_; }

 private:
  struct Constants {
    explicit Constants(const AgentConfig& s);
    AgentConfig scenario;
    PacketCodec codec;
  };
  Agent(std::shared_ptr<const Constants> constants, int id);

  friend class AgentLanes;

  /// The state a packet holds when it is news of a neighbour, else null.
  const NeighbourState* Take(const acoustics::Reception& reception);
  /// Starts the next decision.
  void Begin(TimeNs now);
  void UpdateTrack();
  /// The last Observe's information rests on an observation of late.
  bool Current() const;
  NeighbourView<double> SeeNeighbours() const;

  std::shared_ptr<const Constants> constants_;
  int id_, target_;
  NeighbourTable neighbours_;
  TargetTrack track_;
  Mind<double> mind_;
  dynamics::Cue cue_;
  dynamics::Detection detection_;
  bool cue_pending_ = false, detection_pending_ = false;
  TimeNs now_ = 0;
  std::uint32_t episode_ = 0, step_ = 0, decisions_ = 0;
  std::uint64_t refused_packets_ = 0;
};

/// Agents 0 .. scenario.agents - 1, sharing one copy of the scenario.
std::vector<Agent> MakeAgents(const AgentConfig& scenario);

}  // namespace stg::agent

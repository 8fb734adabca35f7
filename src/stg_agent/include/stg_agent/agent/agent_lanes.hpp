#pragma once

#include <vector>

#include "stg_agent/agent/agent.hpp"

namespace stg::agent {

/// The same AUV's agent in kLanes environments that run in lockstep: same time, same decision
/// count. Does what kLanes objects of class Agent do, bit for bit, with the arithmetic of all
/// lanes side by side; what happens at different times in different lanes (packets, target
/// tracks) stays with one Agent per lane.
///
/// Use as Agent. Allocates nothing after construction.
class AgentLanes {
 public:
  /// Shares scenario and tables with `first`.
  AgentLanes(const Agent& first, int id);

  /// Starts an episode in one lane. Lanes run in lockstep: reset all of them, then Observe.
  void Reset(int lane, std::uint32_t episode, const dynamics::Cue& cue);
  void Detect(int lane, const dynamics::Detection& detection) { At(lane).Detect(detection); }
  void Receive(int lane, const acoustics::Reception& reception);

  /// Brings all knowledge to nav.stamp; the observation is BuildObservation of knowledge().
  /// Throws std::invalid_argument for a non-finite navigation state: a bug of the caller.
  void Observe(const dynamics::Navigation<Pack>& nav);
  const Knowledge<Pack>& knowledge() const { return mind_.knowledge; }

  /// Executes an action [action_size] as Agent::Act; knowledge().tau is then the command.
  void Act(const Pack* action);
  /// Executed action of the last Act; action_size entries count.
  const std::array<Pack, 6>& action() const { return mind_.action; }
  /// What one lane's agent has to tell its neighbours after this decision.
  Packet MakePacket(int lane);

  /// One lane's agent, with all that it knows.
  const Agent& agent(int lane);

 private:
  /// The newest state of one neighbour, as received.
  struct Report {
    Vec3<Pack> p_W, v_W;
    Pack generation_ns = Pack(0.0), tracking_error = Pack(0.0);
    Pack known = Pack(0.0);  ///< 1: the numbers above mean something
  };

  Agent& At(int lane) { return agents_[static_cast<std::size_t>(lane)]; }
  const AgentConfig& scenario() const { return agents_.front().scenario(); }
  /// Drops what is too old in the lanes of the mask.
  void Forget(const Mask<Pack>& past, const dynamics::Navigation<Pack>& nav);
  TargetView<Pack> SeeTarget() const;
  NeighbourView<Pack> SeeNeighbours(const Vec3<Pack>& p_WT) const;

  std::vector<Agent> agents_;    // [kLanes]
  std::vector<Report> reports_;  // [agents]; the own one is never known
  std::vector<Pack> age_s_;      // [agents], scratch of Observe
  Mind<Pack> mind_;
};

}  // namespace stg::agent

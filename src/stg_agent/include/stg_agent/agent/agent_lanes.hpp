#pragma once

#include <array>
#include <vector>

#include "stg_agent/agent/agent_view.hpp"
#include "stg_agent/agent/mind.hpp"
#include "stg_agent/graph/neighbourhood.hpp"
#include "stg_agent/inbox/inbox.hpp"
#include "stg_agent/inbox/ping_answers.hpp"

namespace stg::agent {

/// One AUV's agent in every lane of T: an inbox for each lane, and one Mind that computes all lanes
/// side by side. Class Agent uses T = double. T = Pack is the same AUV in kLanes environments; the
/// results are those of separate agents, bit for bit.
///
/// Each lane has its own clock: one lane may start an episode while the others continue.
///
/// Use, for every decision: Receive and Detect in any order (the result does not depend on it, but
/// packets of one source come in order of arrival), Observe, Act, MakePacket. Deterministic;
/// allocates nothing after construction.
template <class T>
class LanedAgent {
 public:
  /// Throws std::invalid_argument for an index outside the swarm.
  LanedAgent(const SharedConstants& constants, int id);

  /// Starts an episode in one lane, without any knowledge. The cue was true at time 0; the later
  /// the first Observe is, the more uncertain the cue has become.
  void Reset(int lane, std::uint32_t episode, const dynamics::Cue& cue);
  /// Adds a cue of another target, after Reset.
  void AddCue(int lane, const dynamics::Cue& cue) { At(lane).AddCue(cue); }
  void Detect(int lane, const dynamics::Detection& detection);
  void Receive(int lane, const acoustics::Reception& reception);

  /// Brings all knowledge to nav.stamp; the observation is BuildObservation of knowledge().
  /// Throws std::invalid_argument for a non-finite navigation state: a bug of the caller.
  void Observe(const dynamics::Navigation<T>& nav);
  /// The same, but only in the lanes of the mask, such as those that start an episode. The other
  /// lanes keep their knowledge. The navigation of all lanes must be finite.
  void Observe(const dynamics::Navigation<T>& nav, const Mask<T>& lanes);
  const Knowledge<T>& knowledge() const { return mind_.knowledge; }

  /// Executes an action (Eqs. 23-27), once after each Observe; knowledge().tau is then the command.
  /// Throws std::invalid_argument for an action that is not finite.
  /// @param action [action_size], clipped to [-1, 1] inside
  /// @return desired velocity, world axes [m/s]; zero for tau6
  Vec3<T> Act(const T* action);
  /// Executed action of the last Act; only the first action_size entries are used.
  const std::array<T, dynamics::kMaxActionSize>& action() const { return mind_.action; }

  /// The packet of a lane's agent for its modem: own state and target estimate at the last Observe.
  Packet MakePacket(int lane) const;

  /// False: the AUV has left the swarm (fleet.leave) by the last Observe, and sends no packet.
  bool present(int lane) const { return Lane(present_, lane) > 0.5; }

  int id() const { return inbox(0).id(); }
  const AgentModel& model() const { return constants_->model; }
  const Inbox& inbox(int lane) const { return inboxes_[static_cast<std::size_t>(lane)]; }
  /// The received packets of one lane's neighbours.
  const NeighbourTable& neighbours(int lane) const { return neighbours_.table(lane); }
  /// Decisions begun in the episode of a lane.
  int decisions(int lane) const { return static_cast<int>(Lane(mind_.decisions(), lane)); }
  /// All knowledge of one lane's agent after Observe.
  AgentView view(int lane) const;

 private:
  Inbox& At(int lane) { return inboxes_[static_cast<std::size_t>(lane)]; }
  void Think(const dynamics::Navigation<T>& nav, const Mask<T>& lanes);
  /// Sets the vertical velocity of an AUV that surfaces for a fix, until it is back.
  void Surface(T* action) const;
  /// Follows the target that was chosen since the last decision.
  void Follow(int lane, TimeNs now);
  /// Lets the AUV leave and join at the times of the scenario.
  void Attend(int lane, TimeNs now);

  SharedConstants constants_;
  std::vector<Inbox> inboxes_;        // [lanes]
  std::vector<PingAnswers> answers_;  // [lanes]
  std::unique_ptr<acoustics::LinkEstimator> links_;
  Neighbourhood<T> neighbours_;
  Mind<T> mind_;
  T present_ = T(1.0);
  mutable std::vector<EntityMemory> memory_;  // [lanes]; the entity pilot writes it through a view
  mutable std::vector<SearchMemory> search_;  // likewise; empty: no map
  // The state before the present Observe, for lanes that it leaves out.
  typename Neighbourhood<T>::Sights sights_before_;
  Mind<T> mind_before_;
};

using AgentLanes = LanedAgent<Pack>;

extern template class LanedAgent<double>;
extern template class LanedAgent<Pack>;

}  // namespace stg::agent

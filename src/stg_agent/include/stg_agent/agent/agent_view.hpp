#pragma once

#include <array>
#include <vector>

#include "auv_common/numbers/short_list.hpp"
#include "auv_dynamics/control/control_config.hpp"
#include "stg_agent/agent/entity_memory.hpp"
#include "stg_agent/agent/mind.hpp"
#include "stg_agent/graph/knowledge.hpp"
#include "stg_agent/graph/neighbourhood.hpp"
#include "stg_agent/graph/task_view.hpp"
#include "stg_agent/inbox/inbox.hpp"
#include "stg_agent/search/search_memory.hpp"

namespace stg::agent {

/// Largest number of neighbours that a controller reads.
inline constexpr int kNearestKnown = 16;
using NearestSights = ShortList<NeighbourSight<double>, kNearestKnown>;

/// Read-only view of the knowledge and action of one AUV: of an Agent, or of one lane of
/// LanedAgent. It copies some numbers and refers to the agent, which must not change while the view
/// is used.
class AgentView {
 public:
  using Action = std::array<double, dynamics::kMaxActionSize>;

  /// @param mind, sights of all lanes of the agent; the view is of one of them
  template <class T>
  AgentView(const AgentModel& model, const Inbox& inbox, const NeighbourTable& neighbours,
            const Mind<T>& mind, const std::vector<NeighbourSight<T>>& sights, int lane,
            EntityMemory* memory, SearchMemory* search)
      : model_(model),
        inbox_(inbox),
        neighbours_(neighbours),
        knowledge_(LaneOf(mind.knowledge, lane)),
        sights_(sights, lane),
        memory_(memory),
        search_(search) {
    for (std::size_t k = 0; k < action_.size(); ++k) action_[k] = Lane(mind.action[k], lane);
  }

  const AgentModel& model() const { return model_; }
  int id() const { return inbox_.id(); }
  int target() const { return inbox_.target(); }
  /// The targets that the agent estimates: first_target() .. first_target() + beliefs() - 1.
  int first_target() const { return inbox_.first_target(); }
  int beliefs() const { return inbox_.beliefs(); }
  std::uint32_t episode() const { return inbox_.episode(); }

  /// State of knowledge of the last Observe.
  const Knowledge<double>& knowledge() const { return knowledge_; }
  bool lost() const { return knowledge_.lost > 0.5; }
  TaskView task() const { return TaskOf(model_.observation, knowledge_); }
  /// Executed action of the last Act; only the first action_size entries are used.
  const Action& action() const { return action_; }

  /// The target in the frame of the own navigation.
  TargetEstimate estimate() const { return inbox_.estimate(); }
  /// The same in the true world frame, with the full covariance.
  TargetBelief belief() const { return inbox_.belief(); }
  /// The same for any target that the agent estimates.
  TargetEstimate estimate(int target) const { return inbox_.estimate(target); }
  TargetBelief belief(int target) const { return inbox_.belief(target); }
  /// The received packets of the neighbours.
  const NeighbourTable& neighbours() const { return neighbours_; }
  /// A known neighbour at the last Observe.
  NeighbourSight<double> sight(int id) const { return sights_.at(id); }
  /// The known neighbours nearest to this AUV, at most `most` of them, nearest first (ties: lower
  /// index first).
  NearestSights Nearest(int most = kNearestKnown) const;

  /// Memory for the entities, and the present command. It is not constant, because the entity pilot
  /// writes the command.
  EntityMemory& memory() const { return *memory_; }
  /// Follows another target from the next decision on. A target that the agent does not estimate is
  /// ignored; with task.assignment modulo it estimates only one.
  void Follow(int target) const { memory_->follow = target; }
  /// The search map, and the plan that a search law writes; null: there is no map.
  SearchMemory* search() const { return search_; }

  /// Number of packets of this episode that could not be decoded.
  std::uint64_t refused_packets() const { return inbox_.refused_packets(); }

 private:
  const AgentModel& model_;
  const Inbox& inbox_;
  const NeighbourTable& neighbours_;
  Knowledge<double> knowledge_;
  Action action_;
  SightReader sights_;
  EntityMemory* memory_;
  SearchMemory* search_;
};

}  // namespace stg::agent

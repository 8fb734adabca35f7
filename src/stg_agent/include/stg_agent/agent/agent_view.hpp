#pragma once

#include <array>
#include <vector>

#include "auv_dynamics/control/control_config.hpp"
#include "stg_agent/agent/entity_memory.hpp"
#include "stg_agent/graph/knowledge.hpp"
#include "stg_agent/graph/neighbourhood.hpp"
#include "stg_agent/graph/task_view.hpp"
#include "stg_agent/inbox/inbox.hpp"
#include "stg_agent/search/search_memory.hpp"

namespace stg::agent {

/// Everything that one AUV knows and does, read-only: of an Agent, or of one lane of AgentLanes.
/// Holds numbers of its own and refers to the agent, which must not change meanwhile.
class AgentView {
 public:
  using Action = std::array<double, dynamics::kMaxActionSize>;

  AgentView(const AgentModel& model, const Inbox& inbox, const NeighbourTable& neighbours,
            const Knowledge<double>& knowledge, const Action& action, const SightReader& sights,
            EntityMemory* memory, SearchMemory* search = nullptr)
      : model_(model),
        inbox_(inbox),
        neighbours_(neighbours),
        knowledge_(knowledge),
        action_(action),
        sights_(sights),
        memory_(memory),
        search_(search) {}

  const AgentModel& model() const { return model_; }
  int id() const { return inbox_.id(); }
  int target() const { return inbox_.target(); }
  /// The targets that it keeps beliefs of: first_target() .. first_target() + beliefs() - 1.
  int first_target() const { return inbox_.first_target(); }
  int beliefs() const { return inbox_.beliefs(); }
  std::uint32_t episode() const { return inbox_.episode(); }

  /// State of knowledge of the last Observe.
  const Knowledge<double>& knowledge() const { return knowledge_; }
  bool lost() const { return knowledge_.lost > 0.5; }
  TaskView task() const { return TaskOf(model_.observation, knowledge_); }
  /// Executed action of the last Act; action_size entries count.
  const Action& action() const { return action_; }

  /// The target in the frame of the own navigation.
  TargetEstimate estimate() const { return inbox_.estimate(); }
  /// The same in the true world frame, with a whole covariance.
  TargetBelief belief() const { return inbox_.belief(); }
  /// The same of any target that it keeps a belief of.
  TargetEstimate estimate(int target) const { return inbox_.estimate(target); }
  TargetBelief belief(int target) const { return inbox_.belief(target); }
  /// The neighbours' packets, as received.
  const NeighbourTable& neighbours() const { return neighbours_; }
  /// A known neighbour as of the last Observe.
  NeighbourSight<double> sight(int id) const { return sights_.at(id); }
  /// Writes the `count` known neighbours nearest to this AUV, nearest first (ties: lower index
  /// first); returns how many there were.
  int Nearest(int count, NeighbourSight<double>* sights) const;

  /// What it remembers for its entities, and the command that it flies by; a pilot writes the
  /// latter, which is why it is not constant.
  EntityMemory& memory() const { return *memory_; }
  /// Follows another target from the next decision on, of those that it keeps beliefs of; others
  /// are ignored. Where targets are not chosen freely (task.assignment) there is one.
  void Follow(int target) const { memory_->follow = target; }
  /// Where it has searched; null: it keeps no map. A law writes its plan into it.
  SearchMemory* search() const { return search_; }

  /// Packets of this episode that did not decode.
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

#include "entity_learner.hpp"

#include <ros/node_handle.h>

#include "auv_common/error.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "stg_agent/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kWholeUpdate = 0;  // length of a queue: nothing is lost during an update

}  // namespace

std::vector<ros::Subscriber> EntityLearner::Subscribe(const Hooks& hooks) {
  ros::NodeHandle node;
  std::vector<ros::Subscriber> subscribers;
  const boost::function<void(const auv_msgs::SwarmState::ConstPtr&)> truth =
      [this, hooks](const auv_msgs::SwarmState::ConstPtr& m) {
        if (!hooks.wanted(m->episode, m->header.stamp)) return;
        hooks.time(m->header.stamp);
        inlet_->Add(m);
      };
  subscribers.push_back(node.subscribe<auv_msgs::SwarmState>(
      topics::kSwarmState, kWholeUpdate, truth, ros::VoidConstPtr(), NoDelay()));
  for (int i = 0; i < trainer_.scenario().run.agents; ++i) {
    const boost::function<void(const auv_msgs::TaskState::ConstPtr&)> task =
        [this, i, hooks](const auv_msgs::TaskState::ConstPtr& m) {
          if (!hooks.wanted(m->episode, m->header.stamp)) return;
          hooks.flown(i, m->policy_id);
          inlet_->Add(i, m);
        };
    subscribers.push_back(
        node.subscribe<auv_msgs::TaskState>(topics::AuvTopic(i, topics::kTaskState), kWholeUpdate,
                                            task, ros::VoidConstPtr(), NoDelay()));
    const boost::function<void(const auv_msgs::EntityStep::ConstPtr&)> command =
        [this, i, hooks](const auv_msgs::EntityStep::ConstPtr& m) {
          if (hooks.wanted(m->episode, m->header.stamp)) inlet_->Add(i, m);
        };
    subscribers.push_back(
        node.subscribe<auv_msgs::EntityStep>(topics::AuvTopic(i, topics::kEntityStep), kWholeUpdate,
                                             command, ros::VoidConstPtr(), NoDelay()));
  }
  return subscribers;
}

std::vector<OnlineLearner::Episode> EntityLearner::TakeDone() {
  std::vector<Episode> judged;
  for (learn::SwarmEpisode& e : inlet_->TakeDone()) {
    judged.push_back({e.number, e.source, trainer_.Check(e)});
    if (judged.back().finding.flaw == learn::Flaw::kNone) kept_.push_back(std::move(e));
  }
  return judged;
}

OnlineLearner::Bag EntityLearner::ReadBag(const std::string& /*path*/) {
  throw UserError("parameter bags: a network over entities learns from a running graph only");
}

}  // namespace stg::nodes

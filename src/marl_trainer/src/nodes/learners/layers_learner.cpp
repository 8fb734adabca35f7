#include "layers_learner.hpp"

#include <ros/node_handle.h>

#include "../bag_reader.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "stg_agent/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kEveryMessage = 0;  // length of a queue: nothing is lost during an update

}  // namespace

std::vector<ros::Subscriber> LayersLearner::Subscribe(const Hooks& hooks) {
  ros::NodeHandle node;
  std::vector<ros::Subscriber> subscribers;
  for (int i = 0; i < scenario_.run.agents; ++i) {
    const boost::function<void(const auv_msgs::AgentStep::ConstPtr&)> callback =
        [this, i, hooks](const auv_msgs::AgentStep::ConstPtr& m) {
          if (!hooks.wanted(m->episode, m->header.stamp)) return;
          hooks.flown(i, m->policy_id);
          inlet_->Add(i, *m);
        };
    subscribers.push_back(
        node.subscribe<auv_msgs::AgentStep>(topics::AuvTopic(i, topics::kAgentStep), kEveryMessage,
                                            callback, ros::VoidConstPtr(), NoDelay()));
  }
  const boost::function<void(const auv_msgs::StepReport::ConstPtr&)> report =
      [this, hooks](const auv_msgs::StepReport::ConstPtr& m) {
        if (!hooks.wanted(m->episode, m->header.stamp)) return;
        hooks.time(m->header.stamp);
        inlet_->Add(*m);
      };
  subscribers.push_back(node.subscribe<auv_msgs::StepReport>(
      topics::kStepReport, kEveryMessage, report, ros::VoidConstPtr(), NoDelay()));
  return subscribers;
}

std::vector<OnlineLearner::Episode> LayersLearner::Judge(
    std::vector<learn::RecordedEpisode> episodes) {
  std::vector<Episode> judged;
  for (learn::RecordedEpisode& e : episodes) {
    judged.push_back({e.number, e.source, trainer_.Check(e)});
    if (judged.back().finding.flaw == learn::Flaw::kNone) kept_.push_back(std::move(e));
  }
  return judged;
}

OnlineLearner::Bag LayersLearner::ReadBag(const std::string& path) {
  BagContents contents = nodes::ReadBag(path, scenario_.run, ToYaml(scenario_));
  return {Judge(std::move(contents.episodes)), contents.foreign_messages, contents.error};
}

learn::RecordedTrainer::Progress LayersLearner::Update() {
  return trainer_.Update(std::exchange(kept_, {}));
}

}  // namespace stg::nodes

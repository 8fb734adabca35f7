#include "trainer_node.hpp"

#include <auv_msgs/LoadPolicy.h>
#include <auv_msgs/Pause.h>
#include <auv_msgs/Reset.h>
#include <ros/service.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <numeric>

#include "auv_common/nodes/conversions.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "bag_reader.hpp"
#include "learners/make_learner.hpp"
#include "stg_agent/nodes/topics.hpp"
#include "trainer_parameters.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kSummaries = 0;  // length of a queue: nothing may be lost during an update
constexpr double kSummaryPatience_s = 1.0;  // after the last step of an episode
constexpr double kLoadInterval_s = 0.5;     // between attempts to give agents their policy

/// "3 s", for messages.
std::string Seconds(const ros::WallDuration& d) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f s", d.toSec());
  return text;
}

}  // namespace

TrainerNode::TrainerNode()
    : scenario_(LoadScenarioParameters<Scenario>(config::Scope::kWhole)),
      bags_(LoadBagNames()),
      episodes_per_update_(IntegerParameter("episodes_per_update", 8, 1, 10000)),
      updates_(IntegerParameter("updates", 0, 0, 1000000)),
      window_(IntegerParameter("window", 10, 1, 100000)),
      target_lost_rate_(NumberParameter("target_lost_rate", -1.0, -1.0, 1.0)),
      agent_policies_(static_cast<std::size_t>(scenario_.run.agents)),
      began_(ros::WallTime::now()),
      health_("trainer", "trainer", [this](auto& status) { Report(status); }) {
  // The defaults of a launch file depend on it.
  const bool open = scenario_.world.sea.open;
  if (FlagParameter("open_water", open) != open) {
    throw UserError("parameter open_water: must be " + std::string(open ? "true" : "false") +
                    " for the scenario '" + scenario_.run.name + "'");
  }
  learner_ = MakeLearner(scenario_, bags_.empty());
}

void TrainerNode::Spin() {
  std::cout << "trainer: policy '" << learner_->policy_id() << "' in " << learner_->policy_path()
            << std::endl;
  if (bags_.empty()) {
    TrainLive();
  } else {
    TrainOnBags();
  }
}

void TrainerNode::Count(const std::vector<OnlineLearner::Episode>& episodes) {
  for (const OnlineLearner::Episode& episode : episodes) {
    const learn::Finding& finding = episode.finding;
    if (finding.flaw == learn::Flaw::kNone) {
      ++recording_.used;
      collection_.push_back(episode.number);
      continue;
    }
    ++recording_.dropped[static_cast<std::size_t>(finding.flaw)];
    // For a bag, all warnings are logged. For a live run they are limited, because it has no end.
    if (bags_.empty() && !dropped_.Due()) continue;
    ROS_WARN("trainer: %s, episode %u dropped: %s (%s)%s", episode.source.c_str(), episode.number,
             ToString(finding.flaw), finding.where.c_str(), dropped_.more().c_str());
  }
}

void TrainerNode::TrainOnBags() {
  for (const std::string& bag : FindBags(bags_)) {
    const OnlineLearner::Bag contents = learner_->ReadBag(bag);
    if (!contents.error.empty()) {
      ++recording_.unreadable_sources;
      ROS_ERROR("trainer: %s: %s", bag.c_str(), contents.error.c_str());
    }
    recording_.foreign_messages += contents.foreign_messages;
    Count(contents.episodes);
    health_.Tick();
  }
  std::cout << "trainer: " << recording_.Text() << std::endl;
  if (collection_.empty()) throw UserError("no episode to learn from");
  Print(learner_->Update());
  std::cout << "trainer: policy is now '" << learner_->policy_id() << "'" << std::endl;
}

void TrainerNode::Subscribe() {
  OnlineLearner::Hooks hooks;
  hooks.wanted = [this](std::uint32_t episode, const ros::Time& stamp) {
    return episode >= first_episode_ && PossibleStamp(stamp);
  };
  hooks.flown = [this](int agent, const std::string& policy) {
    agent_policies_[static_cast<std::size_t>(agent)] = policy;
  };
  hooks.time = [](const ros::Time& stamp) { SetNodeTime(stamp); };
  subscribers_ = learner_->Subscribe(hooks);
  ros::NodeHandle node;
  const boost::function<void(const auv_msgs::EpisodeSummary::ConstPtr&)> summary =
      [this](const auv_msgs::EpisodeSummary::ConstPtr& m) { OnSummary(*m); };
  subscribers_.push_back(node.subscribe<auv_msgs::EpisodeSummary>(
      topics::kEpisodeSummary, kSummaries, summary, ros::VoidConstPtr(), NoDelay()));
}

void TrainerNode::TrainLive() {
  Subscribe();
  PauseWorld(false);  // an earlier trainer may have been killed while the world was paused
  bool finished = false;
  while (ros::ok() && !finished) {
    HandleMessages(0.05);
    UpdateAgents();
    Count(learner_->TakeDone());
    if (CollectionFull() && SummariesIn()) {
      Learn();
      finished = (updates_ > 0 && updates_done_ >= updates_) || TargetReached();
    }
    health_.Tick();
  }
  std::cout << "trainer: " << (finished ? "finished" : "stopped") << " after " << updates_done_
            << " updates, " << Seconds(ros::WallTime::now() - began_) << ": " << recording_.Text()
            << "\ntrainer: policy '" << learner_->policy_id() << "' in " << learner_->policy_path()
            << std::endl;
}

void TrainerNode::OnSummary(const auv_msgs::EpisodeSummary& message) {
  if (message.episode >= first_episode_ && message.complete) summaries_[message.episode] = message;
}

bool TrainerNode::CollectionFull() {
  if (collection_.size() < static_cast<std::size_t>(episodes_per_update_)) return false;
  if (!full_) full_ = ros::WallTime::now();
  return true;
}

/// A lost summary is waited for only for a limited time. New episodes do not extend it; in lockstep
/// they arrive all the time.
bool TrainerNode::SummariesIn() const {
  if ((ros::WallTime::now() - *full_).toSec() > kSummaryPatience_s) return true;
  return std::all_of(collection_.begin(), collection_.end(),
                     [this](std::uint32_t e) { return summaries_.count(e) > 0; });
}

void TrainerNode::UpdateAgents() {
  const auto stale = [this](const std::string& id) {
    return !id.empty() && id != learner_->policy_id();
  };
  if (std::none_of(agent_policies_.begin(), agent_policies_.end(), stale)) return;
  if ((ros::WallTime::now() - last_load_).toSec() < kLoadInterval_s) return;
  bool all = true;
  for (std::size_t i = 0; i < agent_policies_.size(); ++i) {
    if (stale(agent_policies_[i])) all = LoadPolicy(static_cast<int>(i)) && all;
  }
  last_load_ = ros::WallTime::now();
  if (all) StartEpisode();
}

bool TrainerNode::LoadPolicy(int agent) {
  auv_msgs::LoadPolicy call;
  call.request.path = learner_->policy_path();
  const std::string service = topics::Auv(agent) + "/agent/" + topics::kLoadPolicy;
  if (!ros::service::call(service, call)) {
    ROS_WARN("trainer: no answer of %s", service.c_str());
    return false;
  }
  if (!call.response.success) {
    ROS_ERROR("trainer: AUV %d refuses the policy: %s", agent, call.response.message.c_str());
    return false;
  }
  agent_policies_[static_cast<std::size_t>(agent)] = call.response.policy_id;
  return true;
}

/// Ends the running episode, because an older policy began it.
void TrainerNode::StartEpisode() {
  auv_msgs::Reset call;
  if (ros::service::call(topics::kReset, call) && call.response.success) {
    first_episode_ = call.response.episode;
  }
  learner_->Restart();
}

void TrainerNode::PauseWorld(bool pause) {
  auv_msgs::Pause call;
  call.request.pause = pause;
  ros::service::call(topics::kPause, call);
}

void TrainerNode::Learn() {
  PauseWorld(true);
  // Resumes the world in any case, even after an error.
  const std::shared_ptr<void> resume(nullptr, [this](void*) { PauseWorld(false); });
  const learn::RecordedTrainer::Progress progress = learner_->Update();
  ++updates_done_;
  for (const std::uint32_t episode : collection_) {
    const auto summary = summaries_.find(episode);
    if (summary != summaries_.end()) lost_rates_.push_back(summary->second.lost_rate);
  }
  while (lost_rates_.size() > static_cast<std::size_t>(window_)) lost_rates_.pop_front();
  Print(progress);
  collection_.clear();
  summaries_.clear();
  full_.reset();
  for (int i = 0; i < scenario_.run.agents; ++i) LoadPolicy(i);
  last_load_ = ros::WallTime::now();
  StartEpisode();
}

bool TrainerNode::TargetReached() const {
  if (target_lost_rate_ < 0.0 || lost_rates_.size() < static_cast<std::size_t>(window_)) {
    return false;
  }
  return std::accumulate(lost_rates_.begin(), lost_rates_.end(), 0.0) <=
         target_lost_rate_ * static_cast<double>(window_);
}

/// Prints one line of progress. Return, tail distance, lost rate and share of the band are those of
/// the exploring swarm, by the scenario's own reward.
void TrainerNode::Print(const learn::RecordedTrainer::Progress& p) const {
  double sum = 0.0, tail = 0.0, lost = 0.0, band = 0.0;
  const auto n = static_cast<double>(std::max<std::size_t>(1, summaries_.size()));
  for (const auto& [episode, s] : summaries_) {
    sum += s.episode_return / n;
    tail += s.tail_distance / n;
    lost += s.lost_rate / n;
    band += s.band_share / n;
  }
  std::printf("update %3lld  %8lld steps  %4.0f s", static_cast<long long>(p.updates),
              static_cast<long long>(p.env_steps), (ros::WallTime::now() - began_).toSec());
  if (!p.own_reward) std::printf("  return %7.1f", p.episode_return);
  if (p.own_reward && !summaries_.empty()) std::printf("  return %7.1f", sum);
  if (!summaries_.empty()) std::printf("  tail %.4f m  lost %.3f", tail, lost);
  if (!summaries_.empty() && scenario_.world.sea.open) std::printf("  band %.3f", band);
  std::printf("  %s  %d episodes, %llu dropped, update %.1f s\n", p.report.c_str(), p.episodes,
              static_cast<unsigned long long>(recording_.total_dropped()), p.seconds);
  std::fflush(stdout);
}

void TrainerNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "running");
  if (learner_) {
    status.add("policy", learner_->policy_id());
    status.add("updates", learner_->updates());
    status.add("environment steps", learner_->env_steps());
  }
  status.add("episodes in this collection", collection_.size());
  status.add("episodes used", recording_.used);
  for (std::size_t f = 1; f < recording_.dropped.size(); ++f) {
    status.add(std::string("episodes dropped: ") + ToString(static_cast<learn::Flaw>(f)),
               recording_.dropped[f]);
  }
  status.add("bags unreadable", recording_.unreadable_sources);
  status.add("messages of another type or AUV", recording_.foreign_messages);
  if (recording_.total_dropped() >
          recording_.dropped[static_cast<std::size_t>(learn::Flaw::kUnfinished)] ||
      recording_.unreadable_sources > 0) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "recordings dropped");
  }
}

}  // namespace stg::nodes

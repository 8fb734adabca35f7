#include "world_node.hpp"

#include <algorithm>

#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kQueue = 20;
/// The clock starts here: ROS takes time zero for "not known yet".
constexpr TimeNs kFirstStamp = 1'000'000'000;
constexpr std::size_t kMaxDelays = 10'000;
constexpr TimeNs kRecent = 10'000'000'000;
/// Observers get a step when it is answered, or this long after it was opened [s]: a message on
/// /clock wakes every node, and would do so just when all of them are to decide.
constexpr double kViewDelay_s = 0.005;

}  // namespace

WorldNode::WorldNode()
    : scenario_(LoadScenarioParameters<dynamics::WorldConfig>()),
      world_(scenario_),
      period_(scenario_.decision_period()),
      real_time_factor_(NumberParameter("real_time_factor", 1.0, 0.0, 1000.0)),
      deadline_s_(NumberParameter("deadline", 0.5, 0.001, 3600.0)),
      start_timeout_s_(NumberParameter("start_timeout", 30.0, 0.0, 3600.0)),
      summary_timeout_s_(NumberParameter("summary_timeout", 10.0, 0.0, 3600.0)),
      episodes_(IntegerParameter("episodes", 0, 0, 1'000'000'000)),
      awaited_(TextParameter("wait_for_node", "")),
      wait_for_metrics_(FlagParameter("wait_for_metrics", false)),
      seed_(static_cast<std::uint64_t>(IntegerParameter("seed", 0, 0, 2'147'483'647))),
      start_(kFirstStamp - period_),
      auvs_(static_cast<std::size_t>(scenario_.agents)),
      commands_(auvs_.size()),
      health_("world", "simulation", [this](auto& status) { Report(status); }) {
  WarnOfOverriddenAgents(scenario_.agents);
  ros::NodeHandle node;
  publisher_ =
      std::make_unique<WorldPublisher>(scenario_, NumberParameter("display_rate", 20.0, 0.01, 1e6));
  for (int i = 0; i < scenario_.agents; ++i) {
    const boost::function<void(const geometry_msgs::WrenchStamped::ConstPtr&)> callback =
        [this, i](const auto& message) { OnWrench(i, message); };
    auvs_[static_cast<std::size_t>(i)].subscriber = node.subscribe<geometry_msgs::WrenchStamped>(
        topics::AuvTopic(i, topics::kWrench), kQueue, callback, ros::VoidConstPtr(), NoDelay());
  }
  subscribers_.push_back(
      node.subscribe(topics::kChannelDone, kQueue, &WorldNode::OnChannelDone, this, NoDelay()));
  subscribers_.push_back(
      node.subscribe(topics::kEpisodeSummary, kQueue, &WorldNode::OnSummary, this, NoDelay()));
  services_.push_back(node.advertiseService(topics::kReset, &WorldNode::OnReset, this));
  services_.push_back(node.advertiseService(topics::kPause, &WorldNode::OnPause, this));
  StartEpisode(0);
}

void WorldNode::Spin() {
  PollLoop([this] { return Work(); }, RealtimePriorityParameter());
}

double WorldNode::Work() {
  if (shown_ || real_time_factor_ == 0.0) health_.Tick();
  if (finishing_) {
    if (ros::WallTime::now() > deadline_) done_ = true;
  } else {
    const bool quiet = real_time_factor_ > 0.0 ? Answered() : Complete();
    if (quiet || OpenFor() >= kViewDelay_s) ShowStep();
    if (!paused_) Advance();
  }
  return done_ ? kLoopDone : WaitTime();
}

/// Seconds until something is to be done without a message.
double WorldNode::WaitTime() const {
  double wait_s = 0.05;
  if (running_ && !paused_ && !finishing_) {
    const ros::WallTime next = Complete() ? due_ : deadline_;
    wait_s = std::clamp((next - ros::WallTime::now()).toSec(), 0.0, 0.2);
  }
  return shown_ ? wait_s : std::min(wait_s, std::max(0.0, kViewDelay_s - OpenFor()));
}

void WorldNode::Advance() {
  const ros::WallTime now = ros::WallTime::now();
  if (Complete()) {
    if (!running_ && !ListenersReady()) return;
    if (running_ && now < due_) return;
  } else {
    if (now < deadline_) return;
    CountMisses();
  }
  if (!running_) {
    running_ = true;
    due_ = began_ = now;
    ROS_INFO("world: running '%s' with %d AUVs, seed %llu", scenario_.name.c_str(),
             scenario_.agents, static_cast<unsigned long long>(seed_));
  }
  if (!AtEnd()) {
    StepWorld();
  } else if (episodes_ > 0 && episode_ + 1 >= static_cast<std::uint32_t>(episodes_)) {
    Finish();
  } else {
    StartEpisode(episode_ + 1);
  }
}

/// Who joins while step 0 stands misses nothing, as every topic is latched.
bool WorldNode::ListenersReady() {
  const ros::WallTime now = ros::WallTime::now();
  if (now > deadline_) return true;
  // The metrics node announces summaries once it has seen all of step 0.
  if (wait_for_metrics_ && subscribers_.back().getNumPublishers() == 0) return false;
  if (awaited_.empty()) return true;
  if (awaited_seen_.isZero()) {
    ros::V_string nodes;
    if (!ros::master::getNodes(nodes)) return false;
    if (std::find(nodes.begin(), nodes.end(), awaited_) == nodes.end()) return false;
    awaited_seen_ = now;
  }
  return (now - awaited_seen_).toSec() > 1.5;
}

bool WorldNode::Answered() const {
  return std::all_of(auvs_.begin(), auvs_.end(),
                     [](const Auv& auv) { return !auv.present || auv.answered; });
}

bool WorldNode::Complete() const { return Answered() && (!channel_present_ || channel_answered_); }

void WorldNode::CountMisses() {
  for (std::size_t i = 0; i < auvs_.size(); ++i) {
    Auv& auv = auvs_[i];
    if (auv.answered || !auv.present) continue;
    auv.present = false;
    ROS_WARN("world: no wrench of AUV %zu for step %u, holding its last command", i, step_);
  }
  if (channel_present_ && !channel_answered_) {
    channel_present_ = false;
    ++channel_misses_;
    ROS_WARN("world: acoustic channel did not close step %u, going on without it", step_);
  }
}

void WorldNode::ShowStep() {
  if (shown_) return;
  if (real_time_factor_ > 0.0) publisher_->PublishSwarm();
  publisher_->PublishViews(world_, start_);
  shown_ = true;
}

void WorldNode::StepWorld() {
  ShowStep();
  bool missed = false;
  for (std::size_t i = 0; i < auvs_.size(); ++i) {
    Auv& auv = auvs_[i];
    if (!auv.answered) {
      ++auv.misses;
      missed = true;
    }
    const dynamics::Wrench<double>& c = auv.command;
    commands_[i] = {{Pack(c.force.x), Pack(c.force.y), Pack(c.force.z)},
                    {Pack(c.moment.x), Pack(c.moment.y), Pack(c.moment.z)}};
  }
  if (missed) ++missed_steps_;
  for (int k = 0; k < scenario_.time.decision_steps; ++k) world_.Step(commands_);
  ++step_;
  steps_.Add();
  OpenStep();
}

void WorldNode::StartEpisode(std::uint32_t episode) {
  ShowStep();
  start_ = Now() + period_;
  episode_ = episode;
  step_ = 0;
  // The other lanes run the same world; only lane 0 is looked at.
  for (int lane = 0; lane < kLanes; ++lane) {
    world_.Reset(lane, seed_ + (episode_ - seed_episode_), 0, scenario_.reset.stage);
  }
  for (Auv& auv : auvs_) auv.command = dynamics::Wrench<double>();
  OpenStep();
}

void WorldNode::OpenStep() {
  for (Auv& auv : auvs_) auv.answered = false;
  channel_answered_ = false;
  opened_ = ros::WallTime::now();
  publisher_->PublishSensors(world_, start_, episode_, step_);
  // In lockstep the channel's answer is waited for; on the wall clock it can wait for the AUVs.
  if (real_time_factor_ == 0.0) publisher_->PublishSwarm();
  shown_ = false;
  const ros::WallTime now = ros::WallTime::now();
  if (!running_) {
    deadline_ = now + ros::WallDuration(start_timeout_s_);
  } else if (real_time_factor_ == 0.0) {
    due_ = now;
    deadline_ = now + ros::WallDuration(deadline_s_);
  } else {
    // From the last due time, so that delays do not add up; far behind, catch up no more.
    const double period_s = Seconds(period_) / real_time_factor_;
    due_ += ros::WallDuration(period_s);
    if ((now - due_).toSec() > 5.0 * period_s) due_ = now;
    deadline_ = due_;
  }
}

void WorldNode::Finish() {
  finishing_ = true;
  const double wall_s = (ros::WallTime::now() - began_).toSec();
  const double simulated_s = Seconds(period_) * static_cast<double>(steps_.total());
  ROS_INFO(
      "world: %llu steps in %.3f s, %.1f x real time, %llu with a deadline miss, "
      "from detection to wrench %.3f ms (median), %.3f ms (99 %%)",
      static_cast<unsigned long long>(steps_.total()), wall_s, simulated_s / wall_s,
      static_cast<unsigned long long>(missed_steps_), DelayQuantile(0.5), DelayQuantile(0.99));
  deadline_ = ros::WallTime::now() + ros::WallDuration(summary_timeout_s_);
  if (subscribers_.back().getNumPublishers() == 0) done_ = true;
}

void WorldNode::OnWrench(int i, const geometry_msgs::WrenchStamped::ConstPtr& message) {
  Auv& auv = auvs_[static_cast<std::size_t>(i)];
  if (message->header.frame_id != frames::Body(i)) {
    auv.refused.Add(Refusals::kFrame);
    return;
  }
  if (!FiniteVector(message->wrench.force) || !FiniteVector(message->wrench.torque)) {
    auv.refused.Add(Refusals::kNotFinite);
    return;
  }
  const TimeNs age = Now() - NsOf(message->header.stamp);
  if (age >= 0 && age < kRecent) auv.present = true;  // whoever speaks is waited for again
  if (age != 0) {
    auv.refused.Add(Refusals::kStale);
    return;
  }
  if (auv.answered) return;  // the first answer counts
  auv.answered = true;
  KeepDelay();
  auv.command.force = VectorOf(message->wrench.force);
  auv.command.moment = VectorOf(message->wrench.torque);
}

void WorldNode::KeepDelay() {
  if (!running_) return;  // the first answers wait for nodes to start
  const auto delay = static_cast<float>((ros::WallTime::now() - opened_).toSec() * 1e3);
  if (answer_ms_.size() < kMaxDelays) {
    answer_ms_.push_back(delay);
  } else {
    answer_ms_[next_answer_++ % kMaxDelays] = delay;
  }
}

/// Time from detection to wrench that `share` of the answers stayed within [ms].
double WorldNode::DelayQuantile(double share) const {
  if (answer_ms_.empty()) return 0.0;
  std::vector<float> sorted = answer_ms_;
  const auto index = static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(index),
                   sorted.end());
  return sorted[index];
}

void WorldNode::OnChannelDone(const std_msgs::Header::ConstPtr& message) {
  channel_present_ = true;
  if (NsOf(message->stamp) == Now()) channel_answered_ = true;
}

void WorldNode::OnSummary(const auv_msgs::EpisodeSummary::ConstPtr& message) {
  if (finishing_ && message->episode == episode_) done_ = true;
}

bool WorldNode::OnReset(auv_msgs::Reset::Request& request, auv_msgs::Reset::Response& response) {
  if (finishing_) {
    response.success = false;
    response.message = "the run is over";
    return true;
  }
  if (request.use_seed) {
    seed_ = request.seed;
    seed_episode_ = episode_ + 1;
  }
  StartEpisode(episode_ + 1);
  response.success = true;
  response.episode = episode_;
  return true;
}

bool WorldNode::OnPause(auv_msgs::Pause::Request& request, auv_msgs::Pause::Response& response) {
  const ros::WallTime now = ros::WallTime::now();
  if (paused_ && !request.pause) {
    due_ = now;
    deadline_ = now + ros::WallDuration(running_ ? deadline_s_ : start_timeout_s_);
  }
  paused_ = request.pause;
  response.success = true;
  return true;
}

void WorldNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const char* state = paused_ ? "paused" : running_ ? "running" : "waiting for the first answers";
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, state);
  const double rate = static_cast<double>(steps_.TakeRecent()) / health_.period_s();
  status.add("episode", episode_);
  status.add("step", step_);
  status.add("steps per second", rate);
  status.add("real time factor", rate * Seconds(period_));
  status.add("from detection to wrench, median [ms]", DelayQuantile(0.5));
  status.add("from detection to wrench, 99 % [ms]", DelayQuantile(0.99));
  status.add("steps with a deadline miss", missed_steps_);
  status.add("deadline misses of the channel", channel_misses_);
  for (std::size_t i = 0; i < auvs_.size(); ++i) {
    Auv& auv = auvs_[i];
    const std::string name = topics::AuvTopic(static_cast<int>(i), topics::kWrench);
    status.add("deadline misses " + name, auv.misses);
    auv.refused.Report(name, &status);
    if (!auv.answered && !auv.present) {
      status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "no " + name);
    }
  }
  if (!channel_present_) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "no acoustic channel");
  }
}

}  // namespace stg::nodes

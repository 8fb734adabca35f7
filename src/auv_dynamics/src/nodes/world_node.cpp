#include "world_node.hpp"

#include <algorithm>
#include <string>

#include "auv_common/error.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "auv_dynamics/nodes/autopilot_parameter.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kQueue = 20;
/// The clock starts here, because time zero means "not known yet" in ROS.
constexpr TimeNs kFirstStamp = 1'000'000'000;
/// Observers get a step when it is answered, or this time after it was opened [s]. A message on
/// /clock wakes every node, and without this delay it would do so just when all nodes must decide.
constexpr double kViewDelay_s = 0.005;
/// Warnings are delayed by this time. When a run is stopped, its nodes end one after the other and
/// the world last, so warnings about silent AUVs would be useless.
constexpr double kWarningDelay_s = 2.0;

Pacer::Options PacerParameters(TimeNs period) {
  Pacer::Options options;
  options.period_s = Seconds(period);
  options.real_time_factor = NumberParameter("real_time_factor", 1.0, 0.0, 1000.0);
  options.deadline_s = NumberParameter("deadline", 0.5, 0.001, 3600.0);
  options.start_timeout_s = NumberParameter("start_timeout", 30.0, 0.0, 3600.0);
  return options;
}

}  // namespace

WorldNode::WorldNode()
    : scenario_(LoadScenarioParameters<dynamics::WorldScenario>()),
      world_(scenario_),
      period_(scenario_.run.decision_period()),
      commands_(scenario_.run, scenario_.world.control, scenario_.world.vehicle,
                scenario_.believed().vehicle, world_, AutopilotOnBoardParameter(),
                [this](int i, TimeNs stamp) { return Hear(i, stamp); }),
      pacer_(PacerParameters(period_ / commands_.parts())),
      summary_timeout_s_(NumberParameter("summary_timeout", 10.0, 0.0, 3600.0)),
      episodes_(IntegerParameter("episodes", 0, 0, 1'000'000'000)),
      wait_for_metrics_(FlagParameter("wait_for_metrics", false)),
      seed_(static_cast<std::uint64_t>(IntegerParameter("seed", 0, 0, 2'147'483'647))),
      start_(kFirstStamp - period_),
      barrier_(scenario_.run.agents + 1, period_),
      reported_s_(WallSeconds()),
      fresh_(static_cast<std::size_t>(scenario_.run.agents)),
      health_("world", "simulation", [this](auto& status) { Report(status); }) {
  // The launch file writes here which of its arguments would have no effect.
  const std::string refusal = TextParameter("refusal", "");
  if (!refusal.empty()) throw UserError(refusal);
  WarnOfReplacedKeys(scenario_.run.agents);
  // The world does not use it, but no other node can check the whole list of a launch.
  RequireIndices("external", scenario_.run.agents);
  const std::string awaited = TextParameter("wait_for_node", "");
  if (!awaited.empty()) awaited_.emplace(awaited);
  ros::NodeHandle node;
  publisher_ = std::make_unique<WorldPublisher>(scenario_.run.agents, scenario_.world.target,
                                                NumberParameter("display_rate", 20.0, 0.01, 1e6));
  if (FlagParameter("instruments", false)) {
    instruments_ = std::make_unique<Instruments>(scenario_.run, scenario_.world.sea);
  }
  commands_.Listen();
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
  if (!StoppedBySignal()) Warn();
  if (summary_lost_) throw LostOutput("world: the summary of the last episode did not arrive");
  if (!done_ && !StoppedBySignal()) {
    const std::string asked = episodes_ > 0 ? " of " + std::to_string(episodes_) : "";
    throw LostOutput("world: another node or program ended this one after " +
                     std::to_string(episode_) + asked + " episodes");
  }
}

double WorldNode::Work() {
  if (!warning_.empty() && WallSeconds() - warned_s_ >= kWarningDelay_s) Warn();
  if (shown_ || pacer_.lockstep()) health_.Tick();
  if (finishing_) {
    if (WallSeconds() > give_up_s_) done_ = summary_lost_ = true;
  } else {
    const bool quiet =
        pacer_.lockstep() ? barrier_.Complete() : barrier_.Complete(0, scenario_.run.agents);
    if (quiet || OpenFor() >= kViewDelay_s) ShowStep();
    if (!pacer_.paused() || reset_) Advance();
  }
  return done_ ? kLoopDone : WaitTime();
}

/// Time until the node must act without a message [s].
double WorldNode::WaitTime() const {
  const double wait_s =
      finishing_ ? Pacer::kIdleWait_s : pacer_.WaitTime(WallSeconds(), barrier_.deadline_s());
  return shown_ ? wait_s : std::min(wait_s, std::max(0.0, kViewDelay_s - OpenFor()));
}

void WorldNode::Advance() {
  const double now = WallSeconds();
  for (const int party : barrier_.GiveUp(now)) WarnOfLoss(party);
  if (!barrier_.Complete()) {
    if (!pacer_.running()) ReportMissing(now);
    return;
  }
  if (reset_) {
    StartEpisode(episode_ + 1);
    return;
  }
  if (!pacer_.running()) {
    if (!ListenersReady(now)) return;
    pacer_.Begin(now);
    began_ = now;
    ROS_INFO("world: running '%s' with %d AUVs, seed %llu", scenario_.run.name.c_str(),
             scenario_.run.agents, static_cast<unsigned long long>(seed_));
  } else if (!pacer_.Due(now)) {
    return;
  }
  if (!AtEnd()) {
    StepWorld();
  } else if (episodes_ > 0 && episode_ + 1 >= static_cast<std::uint32_t>(episodes_)) {
    Finish();
  } else {
    StartEpisode(episode_ + 1);
  }
}

/// A node that joins during step 0 misses nothing, because every topic is latched.
bool WorldNode::ListenersReady(double now) {
  // The metrics node advertises summaries once it has received all of step 0.
  const bool metrics = !wait_for_metrics_ || subscribers_.back().getNumPublishers() > 0;
  if (metrics && (!awaited_ || awaited_->Settled(now))) return true;
  if (now <= pacer_.deadline_s()) return false;
  if (awaited_) {
    ROS_WARN(
        "world: %s is still connecting (%d connections); the run starts without waiting for it: "
        "it may miss the start of the run",
        awaited_->node().c_str(), awaited_->connections());
  }
  return true;
}

void WorldNode::ShowStep() {
  if (shown_) return;
  if (!pacer_.lockstep()) publisher_->PublishSwarm();
  publisher_->PublishViews(world_, start_);
  shown_ = true;
}

void WorldNode::StepWorld() {
  ShowStep();
  bool missed = false;
  for (std::size_t i = 0; i < fresh_.size(); ++i) {
    const bool answered = barrier_.answered(static_cast<int>(i));
    // A decision counts as executed only if every part of it was answered.
    fresh_[i] = answered && (part_ == 0 || fresh_[i]) ? 1 : 0;
    if (!answered) missed = true;
  }
  if (missed) ++missed_steps_;
  if (part_ == 0) channel_fresh_ = barrier_.answered(Channel());  // it is excused from later parts
  commands_.Move(scenario_.run.time.decision_steps / commands_.parts(), &world_);
  CheckState();
  barrier_.Close();
  if (++part_ < commands_.parts()) {
    OpenPart();
    return;
  }
  part_ = 0;
  commands_.Tell(fresh_, channel_fresh_, publisher_.get());
  ++step_;
  steps_.Add();
  OpenStep();
}

/// Between two decisions only the autopilots get navigation.
void WorldNode::OpenPart() {
  opened_ = WallSeconds();
  publisher_->PublishNavigation(world_, start_);
  pacer_.Open(WallSeconds());
  barrier_.Open(Now(), pacer_.deadline_s());
  barrier_.Excuse(Channel());
}

/// Ends the run if the state is unusable. The nodes would refuse numbers beyond kLargestInput, and
/// the world would give no reason.
void WorldNode::CheckState() const {
  for (int i = 0; i < scenario_.run.agents; ++i) {
    const dynamics::NavState nav = world_.Truth(0, i);
    if (FiniteVector(nav.p_WB) && FiniteVector(nav.v_WB_B) && FiniteVector(nav.w_WB_B)) continue;
    throw UserError("world: the state of AUV " + std::to_string(i) +
                    " is not finite or beyond 1e6 after step " + std::to_string(step_) +
                    " of episode " + std::to_string(episode_) + ", seed " +
                    std::to_string(world_.seed(0)) + ": " + dynamics::kUnstableHint);
  }
}

void WorldNode::StartEpisode(std::uint32_t episode) {
  ShowStep();
  reset_ = false;
  start_ = Now() + period_;
  episode_ = episode;
  step_ = 0;
  summarised_ = false;
  part_ = 0;
  // The other lanes simulate the same world, but only lane 0 is used.
  for (int lane = 0; lane < kLanes; ++lane) {
    world_.Reset(lane, seed_ + (episode_ - seed_episode_), 0, scenario_.world.reset.stage);
  }
  commands_.Clear();
  fresh_.assign(fresh_.size(), 0);
  commands_.Tell(fresh_, false, publisher_.get());
  OpenStep();
}

void WorldNode::OpenStep() {
  opened_ = WallSeconds();
  SetNodeTime(TimeOf(Now()));
  publisher_->PublishSensors(world_, start_, episode_, step_);
  if (instruments_ != nullptr) instruments_->Publish(world_, Now(), step_ == 0);
  // In lockstep the world waits for the channel's answer. On the wall clock the channel can wait
  // for the AUVs.
  if (pacer_.lockstep()) publisher_->PublishSwarm();
  shown_ = false;
  pacer_.Open(WallSeconds());
  barrier_.Open(Now(), pacer_.deadline_s());
}

void WorldNode::Finish() {
  finishing_ = true;
  const double wall_s = WallSeconds() - began_;
  const double simulated_s = Seconds(period_) * static_cast<double>(steps_.total());
  ROS_INFO(
      "world: %llu steps in %.3f s, %.1f x real time, %llu with a deadline miss, "
      "from detection to wrench %.3f ms (median), %.3f ms (99 %%)",
      static_cast<unsigned long long>(steps_.total()), wall_s, simulated_s / wall_s,
      static_cast<unsigned long long>(missed_steps_), DelayQuantile(0.5), DelayQuantile(0.99));
  give_up_s_ = WallSeconds() + summary_timeout_s_;
  // No node can send a summary. This is an error only if the run was started with metrics.
  if (summarised_) {
    done_ = true;
  } else if (subscribers_.back().getNumPublishers() == 0) {
    done_ = true;
    summary_lost_ = wait_for_metrics_;
  }
}

StepBarrier::Word WorldNode::Hear(int i, TimeNs stamp) {
  const StepBarrier::Word word = barrier_.Hear(i, stamp);
  if (word == StepBarrier::Word::kCounts) KeepDelay();
  return word;
}

void WorldNode::OnChannelDone(const std_msgs::Header::ConstPtr& message) {
  barrier_.Hear(Channel(), NsOf(message->stamp));
}

void WorldNode::OnSummary(const auv_msgs::EpisodeSummary::ConstPtr& message) {
  // The summary may arrive before the last answers to the episode's final state.
  if (!AtEnd() || message->episode != episode_) return;
  summarised_ = true;
  if (finishing_) done_ = true;
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
  // First waits for the answers to the open step, because they would mix with those of the new
  // episode.
  reset_ = true;
  response.success = true;
  response.episode = episode_ + 1;
  return true;
}

bool WorldNode::OnPause(auv_msgs::Pause::Request& request, auv_msgs::Pause::Response& response) {
  if (request.pause) {
    pacer_.Pause();
  } else if (pacer_.paused()) {
    pacer_.Resume(WallSeconds());
    barrier_.Extend(pacer_.deadline_s());
  }
  response.success = true;
  return true;
}

}  // namespace stg::nodes

#include "agent_node.hpp"

#include <algorithm>

#include "acoustic_channel/nodes/conversions.hpp"
#include "acoustic_channel/nodes/topics.hpp"
#include "agent_messages.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_dynamics/control/control.hpp"
#include "auv_dynamics/helm/helm.hpp"
#include "auv_dynamics/nodes/autopilot_parameter.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "run_model.hpp"
#include "stg_agent/nodes/entity_messages.hpp"
#include "stg_agent/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kQueue = 50;
/// Time to connect for a modem that starts together with the agent [s].
constexpr double kStartPatience_s = 5.0;

}  // namespace

AgentNode::AgentNode()
    : model_(ModelOfRun()),
      id_(IntegerParameter("id", 0, 0, model_.run.agents - 1)),
      body_frame_(frames::Body(id_)),
      agent_(model_, id_),
      turns_(model_.channel, agent::NetworkRun(model_.run, model_.stations)),
      decider_(DeciderFor(TextParameter("policy", agent::DefaultController()), model_, id_)),
      period_(model_.run.decision_period()),
      patience_s_(NumberParameter("patience", 0.1, 0.0, 3600.0)),
      report_delay_s_(NumberParameter("report_delay", 0.0, 0.0, 0.05)),
      explore_(ExploreParameter(decider_, id_)),
      commands_velocity_(model_.control.interface == dynamics::ActionInterface::kVelocity3),
      // The parameter comes first, so that it is read whatever the agent commands.
      commands_wrench_((AutopilotOnBoardParameter() && !dynamics::Helm::Steers(model_.vehicle)) ||
                       !commands_velocity_),
      pending_(id_, model_.target.count, model_.sensing.labelled),
      tracker_(period_, model_.run.time.episode_steps),
      barrier_(kParties, period_),
      observation_(static_cast<std::size_t>(model_.observation_size())),
      health_("agent", topics::Auv(id_).substr(1), [this](auto& status) { Report(status); }) {
  Advertise();
  ros::NodeHandle node;
  const auto own = [this](const char* name) { return topics::AuvTopic(id_, name); };
  subscribers_.push_back(
      node.subscribe(own(topics::kSensorFrame), kQueue, &AgentNode::OnFrame, this, NoDelay()));
  subscribers_.push_back(
      node.subscribe(own(topics::kAcousticRx), kQueue, &AgentNode::OnReception, this, NoDelay()));
  load_policy_ =
      ros::NodeHandle("~").advertiseService(topics::kLoadPolicy, &AgentNode::OnLoadPolicy, this);
  const std::string file = decider_.FileOf(id_);
  ROS_INFO("agent %d: flies '%s'%s%s", id_, decider_.IdOf(id_).c_str(), file.empty() ? "" : " of ",
           file.c_str());
}

void AgentNode::Advertise() {
  ros::NodeHandle node;
  const auto own = [this](const char* name) { return topics::AuvTopic(id_, name); };
  if (commands_wrench_) {
    wrench_message_.header.frame_id = body_frame_;
    wrench_ = node.advertise<geometry_msgs::WrenchStamped>(own(topics::kWrench), kQueue, true);
  }
  if (commands_velocity_) {
    velocity_.Advertise(own(topics::kCmdVel), kQueue,
                        [this](auto* message) { return SetVelocity(message); });
  }
  packet_message_.header.frame_id = body_frame_;
  packet_message_.source = static_cast<std::uint32_t>(id_);
  packet_message_.destination = acoustics::kToAll;
  packet_ = node.advertise<auv_msgs::AcousticPacket>(own(topics::kAcousticTx), kQueue, true);
  task_.Advertise(own(topics::kTaskState), kQueue,
                  [this](auto* message) { return SetTask(message); });
  step_.Advertise(own(topics::kAgentStep), kQueue,
                  [this](auto* message) { return SetStep(message); });
  entity_step_.Advertise(own(topics::kEntityStep), kQueue,
                         [this](auto* message) { return SetEntityStep(message); });
  if (agent_.view().search() == nullptr) return;
  search_map_.Advertise(own(topics::kSearchMap), kQueue, [this](auto* message) {
    return decided_ && SetSearchMap(*agent_.view().search(), decided_->header.stamp, message);
  });
}

void AgentNode::Spin() {
  PollLoop([this] { return Work(); }, RealtimePriorityParameter());
}

double AgentNode::Work() {
  DecideIfDue();
  double wait_s = health_.TickWhenQuiet(busy_);
  if (barrier_.open()) {
    wait_s = std::min(wait_s, std::max(barrier_.deadline_s() - WallSeconds(), 0.001));
  }
  if (unreported_) {
    const double left_s = report_delay_s_ - (ros::WallTime::now() - commanded_).toSec();
    if (left_s <= 0.0) {
      ReportDecision();
    } else {
      wait_s = std::min(wait_s, left_s);
    }
  }
  return wait_s;
}

void AgentNode::OnFrame(const auv_msgs::SensorFrame::ConstPtr& message) {
  busy_ = ros::WallTime::now();
  if (message->header.frame_id != body_frame_) {
    refused_frames_.Add(Refusals::kFrame);
    return;
  }
  if (!FiniteFrame(*message)) {
    refused_frames_.Add(Refusals::kNotFinite);
    return;
  }
  const TimeNs stamp = NsOf(message->header.stamp);
  const bool in_run = tracker_.started();
  switch (tracker_.Hear({message->run, message->episode, message->step, stamp})) {
    case StepTracker::Verdict::kRefused:
      refused_frames_.Add(Refusals::kStale);
      return;
    case StepTracker::Verdict::kNewRun:
      if (in_run) ForgetRun();
      break;
    case StepTracker::Verdict::kRepeated:
    case StepTracker::Verdict::kNext:
    case StepTracker::Verdict::kNewEpisode:
      break;
  }
  // At the start of a run the agent waits longer for the modem, because messages of the modem
  // before it is connected are lost.
  const bool first = !in_run && message->episode == 0 && message->step == 0;
  const double patience_s = first ? std::max(patience_s_, kStartPatience_s) : patience_s_;
  const StepBarrier::Opening opening = barrier_.Open(stamp, WallSeconds() + patience_s);
  if (opening == StepBarrier::Opening::kRepeated) return;
  if (opening == StepBarrier::Opening::kReplaced) ++skipped_steps_;
  SetNodeTime(message->header.stamp);
  frame_ = message;
  for (const auto& detection : message->detections) pending_.Keep(detection, stamp);
  // No window comes before step 0, except the first one of a run.
  if (message->step == 0 && !first) barrier_.Excuse(kModem);
  HearModem();
  DecideIfDue();
}

/// Windows come in order. If no packet is due, the next one comes before its step is opened.
void AgentNode::HearModem() {
  const TimeNs stamp = barrier_.stamp();
  if (barrier_.open() && (window_ == stamp || window_ == stamp + period_)) {
    barrier_.Hear(kModem, stamp);
  }
}

void AgentNode::OnReception(const auv_msgs::AcousticReception::ConstPtr& message) {
  if (message->header.frame_id != body_frame_) {
    pending_.refused_receptions().Add(Refusals::kFrame);
  } else {
    const TimeNs stamp = NsOf(message->header.stamp);
    if (barrier_.Hear(kModem, stamp) == StepBarrier::Word::kForeign) {
      pending_.refused_receptions().Add(Refusals::kStale);
      return;
    }
    window_ = stamp;
    HearModem();
    pending_.Keep(message);
    DecideIfDue();
  }
}

bool AgentNode::OnLoadPolicy(auv_msgs::LoadPolicy::Request& request,
                             auv_msgs::LoadPolicy::Response& response) {
  try {
    decider_ = DeciderFor(request.path, model_, id_);
    response.success = true;
    ROS_INFO("agent %d: policy is now '%s'", id_, decider_.IdOf(id_).c_str());
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    ROS_ERROR("agent %d: refuses a new policy and keeps its own: %s", id_, error.what());
  }
  response.policy_id = decider_.IdOf(id_);
  return true;
}

void AgentNode::DecideIfDue() {
  if (!barrier_.open()) return;
  barrier_.GiveUp(WallSeconds());
  if (barrier_.Complete()) Decide();
}

/// Another run begins, and the clock may have gone back.
void AgentNode::ForgetRun() {
  barrier_.Restart();
  frame_.reset();
  pending_.Clear();
  window_ = -1;
  in_episode_ = false;
}

void AgentNode::StartEpisode(const auv_msgs::SensorFrame& frame) {
  const dynamics::Cue cue = CueOf(frame, model_.target.of(id_));
  agent_.Reset(frame.episode, cue);
  for (const dynamics::Cue& other : OtherCues(frame, cue, agent_.target(), model_.target.count)) {
    agent_.AddCue(other);
  }
  turns_.Reset(frame.seed, 0);
  episode_ = frame.episode;
  sequence_ = 0;
  in_episode_ = true;
}

void AgentNode::Decide() {
  if (unreported_) ReportDecision();
  const TimeNs stamp = NsOf(frame_->header.stamp);
  const TimeNs start = stamp - static_cast<TimeNs>(frame_->step) * period_;
  if (!in_episode_ || start != start_ || frame_->episode != episode_) {
    start_ = start;
    StartEpisode(*frame_);
  }
  pending_.Give(start_, stamp, &agent_);
  agent_.Observe(NavOf(*frame_, start_), observation_.data());
  drew_ = false;
  if (decider_.observes()) {
    decider_.Act(id_, observation_.data(), action_);
  } else if (explore_ && decider_.entities != nullptr) {
    drew_ = decider_.Explore(frame_->seed, frame_->step, agent_.view(), &drawn_, action_);
  } else {
    decider_.Act(agent_.view(), action_);
  }
  log_probability_ = explore_ ? decider_.Explore(frame_->seed, frame_->step, id_, action_) : 0.0F;
  policy_id_ = decider_.IdOf(id_);
  output_ = agent_.Act(action_);
  decided_ = std::move(frame_);
  frame_.reset();
  barrier_.Close();
  Command();
  decisions_.Add();
  unreported_ = true;
  commanded_ = ros::WallTime::now();
  if (report_delay_s_ == 0.0) ReportDecision();
}

void AgentNode::Command() {
  if (commands_wrench_) {
    const dynamics::Wrench<double> wrench = dynamics::ScaleWrench(model_.vehicle, output_.fraction);
    wrench_message_.header.stamp = decided_->header.stamp;
    SetVector(wrench.force, &wrench_message_.wrench.force);
    SetVector(wrench.moment, &wrench_message_.wrench.torque);
    wrench_.publish(wrench_message_);
  }
  if (commands_velocity_) velocity_.Publish();
}

void AgentNode::ReportDecision() {
  const ros::Time stamp = decided_->header.stamp;
  // A packet that cannot leave in this step would be replaced by the next one, so it is not made.
  if (turns_.Due(id_, NsOf(stamp) - start_)) {
    packet_message_.header.stamp = packet_message_.generation = stamp;
    packet_message_.sequence = sequence_++;
    packet_message_.data.clear();  // an AUV that has left sends no data
    if (agent_.present()) {
      const agent::Packet packet = agent_.MakePacket();
      packet_message_.data.assign(packet.begin(), packet.end());
    }
    packet_.publish(packet_message_);
  }
  unreported_ = false;
  task_.Publish();
  step_.Publish();
  if (drew_) entity_step_.Publish();
  if (ShowsSearchMap(NsOf(stamp) - start_, period_)) search_map_.Publish();
}

bool AgentNode::SetVelocity(geometry_msgs::TwistStamped* message) const {
  if (!decided_) return false;
  message->header.stamp = decided_->header.stamp;
  message->header.frame_id = frames::kWorld;
  SetVector(output_.cmd_vel_W, &message->twist.linear);
  return true;
}

template <class Message>
bool AgentNode::SetReport(const std::string& frame, Message* message) const {
  if (!decided_ || unreported_) return false;
  message->header.stamp = decided_->header.stamp;
  message->header.frame_id = frame;
  message->episode = decided_->episode;
  message->step = decided_->step;
  return true;
}

bool AgentNode::SetTask(auv_msgs::TaskState* message) const {
  if (!SetReport(frames::kWorld, message)) return false;
  message->policy_id = policy_id_;
  SetTaskState(agent_, output_, message);
  return true;
}

bool AgentNode::SetStep(auv_msgs::AgentStep* message) const {
  if (!SetReport(body_frame_, message)) return false;
  message->agent = static_cast<std::uint32_t>(id_);
  message->observation = observation_;
  message->action.assign(action_, action_ + model_.control.action_size());
  message->log_probability = log_probability_;
  message->policy_id = policy_id_;
  message->observation_layout = agent::kLayoutVersion;
  return true;
}

bool AgentNode::SetEntityStep(auv_msgs::EntityStep* message) const {
  if (!drew_ || !SetReport(body_frame_, message)) return false;
  message->agent = static_cast<std::uint32_t>(id_);
  message->policy_id = policy_id_;
  SetDecision(drawn_, agent::CommandSize(decider_.entities->action()), message);
  return true;
}

void AgentNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "running");
  const double rate = static_cast<double>(decisions_.TakeRecent()) / health_.period_s();
  status.add("policy", decider_.IdOf(id_));
  status.add("decisions", decisions_.total());
  status.add("decisions per second", rate);
  status.add("steps skipped", skipped_steps_);
  status.add("reception windows missing", barrier_.losses(kModem));
  const agent::AgentView view = agent_.view();
  status.add("packets that did not decode", view.refused_packets());
  double age = 0.0;
  for (const int id : view.neighbours().known()) age = std::max(age, view.sight(id).age_s);
  status.add("neighbours known", view.neighbours().known().size());
  status.add("age of information, largest [s]", age);
  refused_frames_.Report(topics::kSensorFrame, &status);
  pending_.Report(&status);
  if (decisions_.total() == 0) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "no decision yet");
  }
  if (!barrier_.present(kModem)) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "the modem is silent");
  }
}

}  // namespace stg::nodes

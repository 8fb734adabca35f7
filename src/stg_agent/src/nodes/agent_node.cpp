#include "agent_node.hpp"

#include <algorithm>
#include <cmath>

#include "acoustic_channel/nodes/conversions.hpp"
#include "acoustic_channel/nodes/topics.hpp"
#include "agent_messages.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "auv_dynamics/control/control.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "stg_agent/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kQueue = 50;
constexpr std::size_t kMaxPending = 100;     // messages kept for a step that may never come
constexpr std::uint32_t kLayoutVersion = 1;  // "stg-1"

}  // namespace

AgentNode::AgentNode()
    : scenario_(LoadScenarioParameters<agent::AgentConfig>()),
      id_(IntegerParameter("id", 0, 0, scenario_.agents - 1)),
      body_frame_(frames::Body(id_)),
      agent_(scenario_, id_),
      turns_(scenario_.channel, scenario_),
      decider_(
          std::make_unique<const Decider>(TextParameter("policy", "pursuit_separated"), scenario_)),
      period_(scenario_.decision_period()),
      patience_s_(NumberParameter("patience", 0.1, 0.0, 3600.0)),
      report_delay_s_(NumberParameter("report_delay", 0.0, 0.0, 0.05)),
      explore_(FlagParameter("explore", false)),
      observation_(static_cast<std::size_t>(scenario_.observation_size())),
      health_("agent", topics::Auv(id_).substr(1), [this](auto& status) { Report(status); }) {
  ros::NodeHandle node;
  const auto own = [this](const char* name) { return topics::AuvTopic(id_, name); };
  if (scenario_.control.interface == dynamics::ActionInterface::kVelocity3) {
    command_ = node.advertise<geometry_msgs::TwistStamped>(own(topics::kCmdVel), kQueue, true);
  } else {
    command_ = node.advertise<geometry_msgs::WrenchStamped>(own(topics::kWrench), kQueue, true);
  }
  packet_ = node.advertise<auv_msgs::AcousticPacket>(own(topics::kAcousticTx), kQueue, true);
  task_ = node.advertise<auv_msgs::TaskState>(own(topics::kTaskState), kQueue, true);
  step_ = node.advertise<auv_msgs::AgentStep>(own(topics::kAgentStep), kQueue, true);
  command_message_.header.frame_id = task_message_.header.frame_id = frames::kWorld;
  wrench_message_.header.frame_id = packet_message_.header.frame_id =
      step_message_.header.frame_id = body_frame_;
  packet_message_.source = step_message_.agent = static_cast<std::uint32_t>(id_);
  packet_message_.destination = acoustics::kToAll;
  step_message_.observation_layout = kLayoutVersion;

  subscribers_.push_back(
      node.subscribe(own(topics::kOdom), kQueue, &AgentNode::OnOdometry, this, NoDelay()));
  subscribers_.push_back(node.subscribe(own(topics::kTargetDetection), kQueue,
                                        &AgentNode::OnDetection, this, NoDelay()));
  subscribers_.push_back(
      node.subscribe(own(topics::kAcousticRx), kQueue, &AgentNode::OnReception, this, NoDelay()));
  subscribers_.push_back(
      node.subscribe(own(topics::kSensorSync), kQueue, &AgentNode::OnSync, this, NoDelay()));
  load_policy_ =
      ros::NodeHandle("~").advertiseService(topics::kLoadPolicy, &AgentNode::OnLoadPolicy, this);
}

void AgentNode::Spin() {
  PollLoop([this] { return Work(); }, RealtimePriorityParameter());
}

double AgentNode::Work() {
  DecideIfDue();
  double wait_s = health_.TickWhenQuiet(busy_);
  if (sync_) wait_s = std::min(wait_s, std::max(patience_s_, 0.001));
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

void AgentNode::OnOdometry(const nav_msgs::Odometry::ConstPtr& message) {
  busy_ = ros::WallTime::now();
  if (message->header.frame_id != frames::kWorld || message->child_frame_id != body_frame_) {
    refused_odometry_.Add(Refusals::kFrame);
  } else if (!FiniteOdometry(*message)) {
    refused_odometry_.Add(Refusals::kNotFinite);
  } else {
    odometry_ = message;
    DecideIfDue();
  }
}

void AgentNode::OnDetection(const auv_msgs::TargetDetection::ConstPtr& message) {
  if (message->header.frame_id != frames::kWorld) {
    refused_detections_.Add(Refusals::kFrame);
  } else if (!FiniteVector(message->position) || !FiniteVector(message->variance) ||
             message->variance.x < 0.0) {
    refused_detections_.Add(Refusals::kNotFinite);
  } else if (message->target >= static_cast<std::uint32_t>(scenario_.target.count) ||
             detections_.size() >= kMaxPending) {
    refused_detections_.Add(Refusals::kMalformed);
  } else {
    detections_.push_back(message);
    DecideIfDue();
  }
}

void AgentNode::OnReception(const auv_msgs::AcousticReception::ConstPtr& message) {
  if (message->header.frame_id != body_frame_) {
    refused_receptions_.Add(Refusals::kFrame);
  } else if (receptions_.size() >= kMaxPending) {
    refused_receptions_.Add(Refusals::kMalformed);
  } else {
    window_ = NsOf(message->header.stamp);
    modem_present_ = true;
    if (!message->packets.empty()) receptions_.push_back(message);
    DecideIfDue();
  }
}

void AgentNode::OnSync(const auv_msgs::SensorSync::ConstPtr& message) {
  if (message->header.frame_id != body_frame_) {
    refused_syncs_.Add(Refusals::kFrame);
    return;
  }
  if (sync_) {
    ++skipped_steps_;
  } else {
    waiting_since_ = ros::WallTime::now();
  }
  sync_ = message;
  DecideIfDue();
}

bool AgentNode::OnLoadPolicy(auv_msgs::LoadPolicy::Request& request,
                             auv_msgs::LoadPolicy::Response& response) {
  try {
    decider_ = std::make_unique<const Decider>(request.path, scenario_);
    response.success = true;
    ROS_INFO("agent %d: policy is now '%s'", id_, decider_->id().c_str());
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    ROS_ERROR("agent %d: keeps its policy: %s", id_, error.what());
  }
  response.policy_id = decider_->id();
  return true;
}

void AgentNode::DecideIfDue() {
  if (!sync_ || !odometry_ || odometry_->header.stamp != sync_->header.stamp) return;
  const auto detected =
      std::count_if(detections_.begin(), detections_.end(),
                    [this](const auto& d) { return d->header.stamp == sync_->header.stamp; });
  const bool sensed = detected >= static_cast<std::ptrdiff_t>(sync_->detections);
  const bool heard = sync_->step == 0 || !modem_present_ || window_ == NsOf(sync_->header.stamp);
  if (!sensed || !heard) {
    if ((ros::WallTime::now() - waiting_since_).toSec() < patience_s_) return;
    if (!sensed) ++missing_detections_;
    if (!heard) {
      ++missing_windows_;
      modem_present_ = false;
    }
  }
  Decide();
}

void AgentNode::StartEpisode(const auv_msgs::SensorSync& sync) {
  dynamics::Cue cue;
  cue.target = -1;  // none
  if (sync.cue_valid && FiniteVector(sync.cue_position) && Finite(sync.cue_std) &&
      sync.cue_std >= 0.0) {
    cue.target = agent_.target();
    cue.p_WT = VectorOf(sync.cue_position);
    cue.std_m = sync.cue_std;
  }
  agent_.Reset(sync.episode, cue);
  turns_.Reset(sync.seed, 0);
  episode_ = sync.episode;
  sequence_ = 0;
  in_episode_ = true;
}

void AgentNode::TakeDetections(TimeNs stamp) {
  for (const auto& m : detections_) {
    const TimeNs t = NsOf(m->header.stamp);
    if (t < start_ || t > stamp) continue;
    dynamics::Detection detection;
    detection.stamp = t - start_;
    detection.target = static_cast<int>(m->target);
    detection.p_WT = VectorOf(m->position);
    detection.std_m = std::sqrt(m->variance.x);
    agent_.Detect(detection);
  }
  detections_.erase(
      std::remove_if(detections_.begin(), detections_.end(),
                     [stamp](const auto& m) { return NsOf(m->header.stamp) <= stamp; }),
      detections_.end());
}

void AgentNode::TakeReceptions(TimeNs stamp) {
  for (const auto& m : receptions_) {
    const TimeNs end = NsOf(m->header.stamp);
    if (end <= start_ || end > stamp) continue;
    for (const auto& packet : m->packets) {
      const acoustics::Reception reception = ReceptionOf(packet, id_, start_);
      if (reception.arrival < 0 || reception.arrival > stamp - start_) {
        refused_receptions_.Add(Refusals::kStale);
      } else {
        agent_.Receive(reception);
      }
    }
  }
  receptions_.erase(
      std::remove_if(receptions_.begin(), receptions_.end(),
                     [stamp](const auto& m) { return NsOf(m->header.stamp) <= stamp; }),
      receptions_.end());
}

void AgentNode::Decide() {
  if (unreported_) ReportDecision();
  const TimeNs stamp = NsOf(sync_->header.stamp);
  const TimeNs start = stamp - static_cast<TimeNs>(sync_->step) * period_;
  if (!in_episode_ || start != start_ || sync_->episode != episode_) {
    start_ = start;
    StartEpisode(*sync_);
  }
  TakeReceptions(stamp);
  TakeDetections(stamp);
  agent_.Observe(NavOf(*odometry_, start_), observation_.data());
  decider_->Mean(agent_, observation_.data(), action_);
  log_probability_ = explore_ ? decider_->Explore(sync_->seed, sync_->step, id_, action_) : 0.0F;
  output_ = agent_.Act(action_);
  Command();
  decisions_.Add();
  unreported_ = std::move(sync_);
  sync_.reset();
  commanded_ = ros::WallTime::now();
  if (report_delay_s_ == 0.0) ReportDecision();
}

void AgentNode::Command() {
  const agent::AgentOutput& output = output_;
  const ros::Time stamp = sync_->header.stamp;
  if (scenario_.control.interface == dynamics::ActionInterface::kVelocity3) {
    command_message_.header.stamp = stamp;
    SetVector(output.cmd_vel_W, &command_message_.twist.linear);
    command_.publish(command_message_);
  } else {
    const dynamics::Wrench<double> wrench =
        dynamics::ScaleWrench(scenario_.vehicle, output.fraction);
    wrench_message_.header.stamp = stamp;
    SetVector(wrench.force, &wrench_message_.wrench.force);
    SetVector(wrench.moment, &wrench_message_.wrench.torque);
    command_.publish(wrench_message_);
  }
}

void AgentNode::ReportDecision() {
  const agent::AgentOutput& output = output_;
  const auv_msgs::SensorSync& sync = *unreported_;
  const ros::Time stamp = sync.header.stamp;
  packet_message_.header.stamp = stamp;
  packet_message_.sequence = sequence_;
  packet_message_.data.clear();
  packet_message_.generation = ros::Time();
  if (turns_.Due(id_, NsOf(stamp) - start_)) {
    const agent::Packet packet = agent_.MakePacket();
    packet_message_.data.assign(packet.begin(), packet.end());
    packet_message_.generation = stamp;
    ++sequence_;
  }
  packet_.publish(packet_message_);
  task_message_.header.stamp = stamp;
  task_message_.episode = sync.episode;
  task_message_.step = sync.step;
  task_message_.policy_id = decider_->id();
  SetTaskState(agent_, output, &task_message_);
  task_.publish(task_message_);
  step_message_.header.stamp = stamp;
  step_message_.episode = sync.episode;
  step_message_.step = sync.step;
  step_message_.observation = observation_;
  step_message_.action.assign(action_, action_ + scenario_.action_size());
  step_message_.log_probability = log_probability_;
  step_message_.policy_id = decider_->id();
  step_.publish(step_message_);
  unreported_.reset();
}

void AgentNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "running");
  const double rate = static_cast<double>(decisions_.TakeRecent()) / health_.period_s();
  status.add("policy", decider_->id());
  status.add("decisions", decisions_.total());
  status.add("decisions per second", rate);
  status.add("steps skipped", skipped_steps_);
  status.add("reception windows missing", missing_windows_);
  status.add("detections missing", missing_detections_);
  status.add("packets that did not decode", agent_.refused_packets());
  double age = 0.0;
  for (const int id : agent_.neighbours().known()) {
    age = std::max(age, agent_.neighbours().at(id).age_s);
  }
  status.add("neighbours known", agent_.neighbours().known().size());
  status.add("age of information, largest [s]", age);
  refused_odometry_.Report(topics::kOdom, &status);
  refused_detections_.Report(topics::kTargetDetection, &status);
  refused_receptions_.Report(topics::kAcousticRx, &status);
  refused_syncs_.Report(topics::kSensorSync, &status);
  if (decisions_.total() == 0) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "no decision yet");
  }
  if (!modem_present_) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "the modem is silent");
  }
}

}  // namespace stg::nodes

#include "controller_node.hpp"

#include "auv_common/error.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "auv_dynamics/control/control.hpp"
#include "auv_dynamics/helm/helm.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kQueue = 20;

}  // namespace

ControllerNode::ControllerNode()
    : scenario_(LoadScenarioParameters<dynamics::WorldScenario>()),
      believed_(scenario_.believed().vehicle),
      id_(IntegerParameter("id", 0, 0, scenario_.run.agents - 1)),
      body_frame_(frames::Body(id_)),
      period_(scenario_.run.decision_period()),
      // An autopilot also accepts a late command, because it is better than an older one.
      waiting_(period_, dynamics::Helm::Steers(scenario_.world.vehicle) ? period_ - 1 : 0),
      health_("velocity controller", topics::Auv(id_).substr(1),
              [this](auto& status) { Report(status); }) {
  if (scenario_.world.control.interface != dynamics::ActionInterface::kVelocity3) {
    ROS_INFO("the scenario's policy commands force and moment itself: nothing to control");
    return;
  }
  ros::NodeHandle node;
  if (dynamics::Helm::Steers(scenario_.world.vehicle)) {
    const std::string& model = scenario_.world.vehicle.model_of(id_);
    const dynamics::AutopilotConfig& autopilot = scenario_.world.control.autopilot;
    autopilot_ = dynamics::Autopilots().Make(model, autopilot.kinds, believed_, autopilot);
    memory_.assign(static_cast<std::size_t>(autopilot_->state_size()), 0.0);
    actuators_.header.frame_id = body_frame_;
    actuators_.vehicle = model;
    actuators_.values.resize(
        dynamics::Vehicles()
            .Make(model, scenario_.world.vehicle.kinds, scenario_.world.vehicle)
            ->actuators()
            .size());
    publisher_ = node.advertise<auv_msgs::ActuatorCommand>(
        topics::AuvTopic(id_, topics::kActuators), kQueue, true);
    frames_ = node.subscribe(topics::AuvTopic(id_, topics::kSensorFrame), kQueue,
                             &ControllerNode::OnFrame, this, NoDelay());
  } else {
    wrench_.header.frame_id = body_frame_;
    publisher_ = node.advertise<geometry_msgs::WrenchStamped>(
        topics::AuvTopic(id_, topics::kWrench), kQueue, true);
  }
  odometry_ = node.subscribe(topics::AuvTopic(id_, topics::kOdom), kQueue,
                             &ControllerNode::OnOdometry, this, NoDelay());
  commands_ = node.subscribe(topics::AuvTopic(id_, topics::kCmdVel), kQueue,
                             &ControllerNode::OnCommand, this, NoDelay());
}

void ControllerNode::Spin() {
  PollLoop([this] { return Work(); }, RealtimePriorityParameter());
}

double ControllerNode::Work() { return health_.TickWhenQuiet(busy_); }

void ControllerNode::OnOdometry(const nav_msgs::Odometry::ConstPtr& message) {
  busy_ = ros::WallTime::now();
  if (message->header.frame_id != frames::kWorld || message->child_frame_id != body_frame_) {
    refused_odometry_.Add(Refusals::kFrame);
  } else if (!FiniteOdometry(*message)) {
    refused_odometry_.Add(Refusals::kNotFinite);
  } else if (!PossibleStamp(message->header.stamp)) {
    refused_odometry_.Add(Refusals::kStale);
  } else {
    SetNodeTime(message->header.stamp);
    if (has_nav_ && NsOf(message->header.stamp) < nav_.stamp) Forget();  // another run
    nav_ = NavOf(*message, 0);
    has_nav_ = true;
    Refuse(waiting_.Advance(nav_.stamp));
    Answer();
  }
}

void ControllerNode::OnCommand(const geometry_msgs::TwistStamped::ConstPtr& message) {
  if (message->header.frame_id != frames::kWorld) {
    refused_commands_.Add(Refusals::kFrame);
    return;
  }
  if (!FiniteVector(message->twist.linear)) {
    refused_commands_.Add(Refusals::kNotFinite);
    return;
  }
  Refuse(waiting_.Add({NsOf(message->header.stamp), VectorOf(message->twist.linear)}));
  Answer();
}

void ControllerNode::Refuse(int commands) {
  for (int k = 0; k < commands; ++k) refused_commands_.Add(Refusals::kStale);
}

void ControllerNode::OnFrame(const auv_msgs::SensorFrame::ConstPtr& message) {
  if (message->header.frame_id != body_frame_) return;  // the odometry shows this error, too
  const TimeNs stamp = NsOf(message->header.stamp);
  if (stamp == framed_) return;
  framed_ = stamp;
  if (message->step == 0) Begin(stamp);
  Answer();
}

/// Starts an episode with the odometry of `stamp`, which has arrived already or comes later.
/// Answers to earlier odometry belong to the previous episode.
void ControllerNode::Begin(TimeNs stamp) {
  if (!has_nav_ || stamp > nav_.stamp) {
    begins_ = stamp;
    return;
  }
  // Before any publisher of frames was known, this odometry was answered without its frame.
  const bool begun = began_ == stamp && answered_ - stamp < period_;
  if (!begun) Forget();
}

/// Resets the autopilot's memory for a new episode.
void ControllerNode::Forget() {
  memory_.assign(memory_.size(), 0.0);
  began_ = begins_ = -1;
}

void ControllerNode::Answer() {
  const dynamics::WaitingCommands::Command* command = waiting_.Current();
  if (command == nullptr) return;
  if (autopilot_ == nullptr) {
    AnswerWithWrench(*command);
  } else if (Steerable(*command)) {
    AnswerWithActuators(*command);
  } else {
    return;
  }
  waiting_.Take();
}

/// True if the newest odometry has no answer yet, and if it is known whether an episode begins with
/// it.
bool ControllerNode::Steerable(const dynamics::WaitingCommands::Command& command) const {
  if (nav_.stamp == answered_) return false;
  // A frame says whether an episode begins. It may arrive later than the velocity for the same
  // odometry.
  return nav_.stamp > command.stamp || frames_.getNumPublishers() == 0 || framed_ == nav_.stamp;
}

void ControllerNode::AnswerWithActuators(const dynamics::WaitingCommands::Command& command) {
  if (begins_ == nav_.stamp) Forget();
  const double dt_s = scenario_.run.time.dt_s * scenario_.world.control.autopilot.period_steps;
  autopilot_->Steer(command.v_des_W, nav_, dt_s, memory_.data(), actuators_.values.data());
  actuators_.header.stamp = TimeOf(nav_.stamp);
  publisher_.publish(actuators_);
  answered_ = nav_.stamp;
  if (began_ < 0) began_ = answered_;
  answers_.Add();
}

void ControllerNode::AnswerWithWrench(const dynamics::WaitingCommands::Command& command) {
  double fraction[6];
  dynamics::VelocityController(scenario_.world.control, believed_, command.v_des_W, nav_, fraction);
  const dynamics::Wrench<double> wrench = dynamics::ScaleWrench(believed_, fraction);
  wrench_.header.stamp = TimeOf(command.stamp);
  SetVector(wrench.force, &wrench_.wrench.force);
  SetVector(wrench.moment, &wrench_.wrench.torque);
  publisher_.publish(wrench_);
  answers_.Add();
}

void ControllerNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "running");
  const std::uint64_t recent = answers_.TakeRecent();
  status.add("commands", answers_.total());
  status.add("commands per second", static_cast<double>(recent) / health_.period_s());
  if (!has_nav_) status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "no odometry yet");
  refused_commands_.Report(topics::kCmdVel, &status);
  refused_odometry_.Report(topics::kOdom, &status);
}

}  // namespace stg::nodes

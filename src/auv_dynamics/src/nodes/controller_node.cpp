#include "controller_node.hpp"

#include "auv_common/error.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "auv_dynamics/control/control.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kQueue = 20;

}  // namespace

ControllerNode::ControllerNode()
    : scenario_(LoadScenarioParameters<dynamics::WorldConfig>()),
      id_(IntegerParameter("id", 0, 0, scenario_.agents - 1)),
      body_frame_(frames::Body(id_)),
      period_(scenario_.decision_period()),
      health_("velocity controller", topics::Auv(id_).substr(1),
              [this](auto& status) { Report(status); }) {
  if (scenario_.control.interface != dynamics::ActionInterface::kVelocity3) {
    ROS_INFO("the scenario's policy commands force and moment itself: nothing to control");
    return;
  }
  wrench_.header.frame_id = body_frame_;
  ros::NodeHandle node;
  publisher_ = node.advertise<geometry_msgs::WrenchStamped>(topics::AuvTopic(id_, topics::kWrench),
                                                            kQueue, true);
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
    nav_ = NavOf(*message, 0);
    has_nav_ = true;
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
  // A command answers the newest odometry, or one that is still on its way.
  const TimeNs ahead = NsOf(message->header.stamp) - nav_.stamp;
  if (has_nav_ && (ahead < 0 || ahead > period_)) {
    refused_commands_.Add(Refusals::kStale);
    return;
  }
  command_ = message;
  Answer();
}

void ControllerNode::Answer() {
  if (!has_nav_ || !command_ || NsOf(command_->header.stamp) != nav_.stamp) return;
  double fraction[6];
  dynamics::VelocityController(scenario_.control, scenario_.vehicle,
                               VectorOf(command_->twist.linear), nav_, fraction);
  const dynamics::Wrench<double> wrench = dynamics::ScaleWrench(scenario_.vehicle, fraction);
  wrench_.header.stamp = command_->header.stamp;
  SetVector(wrench.force, &wrench_.wrench.force);
  SetVector(wrench.moment, &wrench_.wrench.torque);
  publisher_.publish(wrench_);
  command_.reset();
  answers_.Add();
}

void ControllerNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "running");
  const std::uint64_t recent = answers_.TakeRecent();
  status.add("wrenches", answers_.total());
  status.add("wrenches per second", static_cast<double>(recent) / health_.period_s());
  if (!has_nav_) status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "no odometry yet");
  refused_commands_.Report(topics::kCmdVel, &status);
  refused_odometry_.Report(topics::kOdom, &status);
}

}  // namespace stg::nodes

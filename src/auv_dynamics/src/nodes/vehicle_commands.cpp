#include "vehicle_commands.hpp"

#include <algorithm>

#include "auv_common/nodes/node_main.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "auv_dynamics/world/helm.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kCommandQueue = 20;

}  // namespace

VehicleCommands::VehicleCommands(const dynamics::WorldConfig& scenario,
                                 const dynamics::World& world, Hear hear)
    : hear_(std::move(hear)),
      vehicle_(scenario.vehicle.model),
      actuators_(world.model().actuators()),
      steered_(dynamics::Helm::Steers(scenario)),
      parts_(steered_ ? scenario.time.decision_steps / scenario.control.autopilot.period_steps : 1),
      refused_(static_cast<std::size_t>(scenario.agents)),
      wrenches_(steered_ ? 0 : refused_.size()),
      wrenches_of_lanes_(wrenches_.size()),
      values_(steered_ ? refused_.size() * actuators_.size() : 0),
      values_of_lanes_(values_.size(), Pack(0.0)) {}

void VehicleCommands::Listen() {
  ros::NodeHandle node;
  for (int i = 0; i < static_cast<int>(refused_.size()); ++i) {
    if (steered_) {
      const boost::function<void(const auv_msgs::ActuatorCommand::ConstPtr&)> callback =
          [this, i](const auto& message) { OnActuators(i, message); };
      subscribers_.push_back(node.subscribe<auv_msgs::ActuatorCommand>(
          topics::AuvTopic(i, topics::kActuators), kCommandQueue, callback, ros::VoidConstPtr(),
          NoDelay()));
    } else {
      const boost::function<void(const geometry_msgs::WrenchStamped::ConstPtr&)> callback =
          [this, i](const auto& message) { OnWrench(i, message); };
      subscribers_.push_back(node.subscribe<geometry_msgs::WrenchStamped>(
          topics::AuvTopic(i, topics::kWrench), kCommandQueue, callback, ros::VoidConstPtr(),
          NoDelay()));
    }
  }
}

const char* VehicleCommands::topic() const {
  return steered_ ? topics::kActuators : topics::kWrench;
}

void VehicleCommands::Clear() {
  wrenches_.assign(wrenches_.size(), dynamics::Wrench<double>());
  values_.assign(values_.size(), 0.0);
}

void VehicleCommands::Move(int steps, dynamics::World* world) {
  if (steered_) {
    std::copy(values_.begin(), values_.end(), values_of_lanes_.begin());
    for (int k = 0; k < steps; ++k) world->Step(values_of_lanes_);
    return;
  }
  for (std::size_t i = 0; i < wrenches_.size(); ++i) {
    wrenches_of_lanes_[i] = {Broadcast(wrenches_[i].force), Broadcast(wrenches_[i].moment)};
  }
  for (int k = 0; k < steps; ++k) world->Step(wrenches_of_lanes_);
}

void VehicleCommands::Tell(const std::vector<std::uint8_t>& fresh, bool channel_fresh,
                           WorldPublisher* publisher) const {
  if (!steered_) {
    publisher->SetWrenches(wrenches_, fresh, channel_fresh);
    return;
  }
  const std::size_t most = dynamics::kWrenchSize, size = actuators_.size();
  std::vector<double> efforts(refused_.size() * most, 0.0);
  for (std::size_t i = 0; i < refused_.size(); ++i) {
    for (std::size_t k = 0; k < std::min(size, most); ++k) {
      efforts[i * most + k] = values_[i * size + k] / dynamics::LargestOf(actuators_[k]);
    }
  }
  publisher->SetEfforts(efforts, fresh, channel_fresh);
}

/// Whether a command is the first of this AUV for the open step, and well-formed.
bool VehicleCommands::Counts(int i, const std_msgs::Header& header, bool finite) {
  if (header.frame_id != frames::Body(i)) {
    refused(i).Add(Refusals::kFrame);
    return false;
  }
  if (!finite) {
    refused(i).Add(Refusals::kNotFinite);
    return false;
  }
  switch (hear_(i, NsOf(header.stamp))) {
    case StepBarrier::Word::kCounts:
      return true;
    case StepBarrier::Word::kDuplicate:
      return false;
    case StepBarrier::Word::kLate:
    case StepBarrier::Word::kEarly:
    case StepBarrier::Word::kForeign:
      refused(i).Add(Refusals::kStale);
      return false;
  }
  return false;
}

void VehicleCommands::OnWrench(int i, const geometry_msgs::WrenchStamped::ConstPtr& message) {
  const bool finite = FiniteVector(message->wrench.force) && FiniteVector(message->wrench.torque);
  if (!Counts(i, message->header, finite)) return;
  wrenches_[static_cast<std::size_t>(i)] = {VectorOf(message->wrench.force),
                                            VectorOf(message->wrench.torque)};
}

void VehicleCommands::OnActuators(int i, const auv_msgs::ActuatorCommand::ConstPtr& message) {
  const std::vector<double>& values = message->values;
  if (message->vehicle != vehicle_ || values.size() != actuators_.size()) {
    refused(i).Add(Refusals::kMalformed);
    return;
  }
  const bool finite =
      std::all_of(values.begin(), values.end(), [](double value) { return Finite(value); });
  if (!Counts(i, message->header, finite)) return;
  std::copy(values.begin(), values.end(),
            values_.begin() +
                static_cast<std::ptrdiff_t>(i) * static_cast<std::ptrdiff_t>(actuators_.size()));
}

}  // namespace stg::nodes

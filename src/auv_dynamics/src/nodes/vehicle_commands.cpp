#include "vehicle_commands.hpp"

#include <algorithm>

#include "auv_common/nodes/node_main.hpp"
#include "auv_dynamics/helm/helm.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kCommandQueue = 20;

}  // namespace

VehicleCommands::VehicleCommands(const RunConfig& run, const dynamics::ControlConfig& control,
                                 const dynamics::VehicleConfig& vehicle,
                                 const dynamics::VehicleConfig& believed,
                                 const dynamics::World& world, bool onboard, Hear hear)
    : hear_(std::move(hear)),
      vehicle_(vehicle),
      row_(world.command_size()),
      steered_(dynamics::Helm::Steers(vehicle)),
      helm_(steered_ && onboard
                ? std::make_unique<dynamics::Helm>(vehicle, believed, control.autopilot, run)
                : nullptr),
      parts_(steered_ && !onboard ? run.time.decision_steps / control.autopilot.period_steps : 1),
      refused_(static_cast<std::size_t>(run.agents)),
      wrenches_(steered_ ? 0 : refused_.size()),
      wrenches_of_lanes_(wrenches_.size()),
      values_(steered_ && !onboard ? refused_.size() * row_ : 0),
      values_of_lanes_(values_.size(), Pack(0.0)),
      v_des_W_(helm_ != nullptr ? refused_.size() : 0) {
  for (int i = 0; i < run.agents; ++i) actuators_.push_back(world.model(i).actuators());
}

template <class Message>
void VehicleCommands::Subscribe(
    int i, void (VehicleCommands::*take)(int, const boost::shared_ptr<Message const>&)) {
  const boost::function<void(const boost::shared_ptr<Message const>&)> callback =
      [this, i, take](const auto& message) { (this->*take)(i, message); };
  subscribers_.push_back(ros::NodeHandle().subscribe<Message>(
      topics::AuvTopic(i, topic()), kCommandQueue, callback, ros::VoidConstPtr(), NoDelay()));
}

void VehicleCommands::Listen() {
  for (int i = 0; i < static_cast<int>(refused_.size()); ++i) {
    if (helm_ != nullptr) {
      Subscribe(i, &VehicleCommands::OnVelocity);
    } else if (steered_) {
      Subscribe(i, &VehicleCommands::OnActuators);
    } else {
      Subscribe(i, &VehicleCommands::OnWrench);
    }
  }
}

const char* VehicleCommands::topic() const {
  if (helm_ != nullptr) return topics::kCmdVel;
  return steered_ ? topics::kActuators : topics::kWrench;
}

void VehicleCommands::Clear() {
  wrenches_.assign(wrenches_.size(), dynamics::Wrench<double>());
  values_.assign(values_.size(), 0.0);
  v_des_W_.assign(v_des_W_.size(), {});
  if (helm_ == nullptr) return;
  for (int lane = 0; lane < kLanes; ++lane) helm_->Reset(lane);
}

void VehicleCommands::Move(int steps, dynamics::World* world) {
  if (helm_ != nullptr) {
    helm_->Drive(v_des_W_, world);
    return;
  }
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
  if (steered_) {
    publisher->SetEfforts(Efforts(), fresh, channel_fresh);
  } else {
    publisher->SetWrenches(wrenches_, fresh, channel_fresh);
  }
}

/// Shares of the actuators' limits, kWrenchSize numbers for each AUV.
std::vector<double> VehicleCommands::Efforts() const {
  constexpr std::size_t kMost = dynamics::kWrenchSize;
  std::vector<double> efforts(refused_.size() * kMost, 0.0);
  for (std::size_t i = 0; i < refused_.size(); ++i) {
    if (helm_ != nullptr) {
      Pack shares[kMost] = {};
      helm_->WriteShares(static_cast<int>(i), shares);
      for (std::size_t k = 0; k < kMost; ++k) efforts[i * kMost + k] = Lane(shares[k], 0);
      continue;
    }
    const dynamics::Space& axes = actuators_[i];
    for (std::size_t k = 0; k < std::min<std::size_t>(axes.size(), kMost); ++k) {
      efforts[i * kMost + k] = values_[i * row_ + k] / dynamics::LargestOf(axes[k]);
    }
  }
  return efforts;
}

/// True if a command is well-formed and the first one of this AUV for the open step.
bool VehicleCommands::Counts(int i, const std_msgs::Header& header, const std::string& frame,
                             bool finite) {
  if (header.frame_id != frame) {
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
  if (!Counts(i, message->header, frames::Body(i), finite)) return;
  wrenches_[static_cast<std::size_t>(i)] = {VectorOf(message->wrench.force),
                                            VectorOf(message->wrench.torque)};
}

void VehicleCommands::OnActuators(int i, const auv_msgs::ActuatorCommand::ConstPtr& message) {
  const std::vector<double>& values = message->values;
  const auto u = static_cast<std::size_t>(i);
  if (message->vehicle != vehicle_.model_of(i) || values.size() != actuators_[u].size()) {
    refused(i).Add(Refusals::kMalformed);
    return;
  }
  const bool finite =
      std::all_of(values.begin(), values.end(), [](double value) { return Finite(value); });
  if (!Counts(i, message->header, frames::Body(i), finite)) return;
  std::copy(values.begin(), values.end(), values_.begin() + static_cast<std::ptrdiff_t>(u * row_));
}

void VehicleCommands::OnVelocity(int i, const geometry_msgs::TwistStamped::ConstPtr& message) {
  const bool finite = FiniteVector(message->twist.linear);
  if (!Counts(i, message->header, frames::kWorld, finite)) return;
  v_des_W_[static_cast<std::size_t>(i)] = Broadcast(VectorOf(message->twist.linear));
}

}  // namespace stg::nodes

#pragma once

#include <auv_msgs/ActuatorCommand.h>
#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/node_handle.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "auv_common/nodes/health.hpp"
#include "auv_common/step/step_barrier.hpp"
#include "auv_dynamics/helm/helm.hpp"
#include "auv_dynamics/world/world.hpp"
#include "world_publisher.hpp"

namespace stg::nodes {

/// The newest command of each AUV, and its effect on the world. A command is force and moment. For
/// vehicles with an autopilot it is the values of the actuators, or a velocity if the autopilots
/// run on board, which is in this process.
class VehicleCommands {
 public:
  /// Reports a message of an AUV about the step at this stamp, and returns its meaning. It is
  /// called for well-formed commands.
  using Hear = std::function<StepBarrier::Word(int auv, TimeNs stamp)>;

  /// @param control of the autopilots
  /// @param believed the vehicles as their autopilots assume them
  /// @param onboard the autopilots run here, with one command per decision
  VehicleCommands(const RunConfig& run, const dynamics::ControlConfig& control,
                  const dynamics::VehicleConfig& vehicle, const dynamics::VehicleConfig& believed,
                  const dynamics::World& world, bool onboard, Hear hear);
  VehicleCommands(const VehicleCommands&) = delete;
  VehicleCommands& operator=(const VehicleCommands&) = delete;

  /// Subscribes to the commands of all AUVs.
  void Listen();
  /// Drops all commands, because an episode starts.
  void Clear();
  /// Steps the world with the newest commands, the same in all lanes.
  void Move(int steps, dynamics::World* world);
  /// Publishes the forces on the AUVs, for the nodes that judge the run.
  /// @param fresh of each AUV: its command was for the last step
  /// @param channel_fresh the acoustic channel had closed the last step
  void Tell(const std::vector<std::uint8_t>& fresh, bool channel_fresh,
            WorldPublisher* publisher) const;
  /// Number of parts of a decision: periods of autopilots that are not on board.
  int parts() const { return parts_; }
  /// Name of the topic, relative to the AUV's.
  const char* topic() const;
  Refusals& refused(int auv) { return refused_[static_cast<std::size_t>(auv)]; }

 private:
  void OnWrench(int i, const geometry_msgs::WrenchStamped::ConstPtr& message);
  void OnActuators(int i, const auv_msgs::ActuatorCommand::ConstPtr& message);
  void OnVelocity(int i, const geometry_msgs::TwistStamped::ConstPtr& message);
  template <class Message>
  void Subscribe(int i,
                 void (VehicleCommands::*take)(int, const boost::shared_ptr<Message const>&));
  bool Counts(int i, const std_msgs::Header& header, const std::string& frame, bool finite);
  std::vector<double> Efforts() const;

  Hear hear_;
  dynamics::VehicleConfig vehicle_;
  std::vector<dynamics::Space> actuators_;  ///< [agents]
  std::size_t row_;                         ///< number of values per AUV in values_
  bool steered_;                          ///< the vehicles have autopilots, which command actuators
  std::unique_ptr<dynamics::Helm> helm_;  ///< the autopilots on board; otherwise null
  int parts_;
  std::vector<Refusals> refused_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<dynamics::Wrench<double>> wrenches_;
  std::vector<dynamics::Wrench<Pack>> wrenches_of_lanes_;
  std::vector<double> values_;  ///< [agents, row_]
  std::vector<Pack> values_of_lanes_;
  std::vector<Vec3<Pack>> v_des_W_;  ///< [agents], for the helm
};

}  // namespace stg::nodes

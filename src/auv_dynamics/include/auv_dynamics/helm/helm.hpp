#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "auv_dynamics/autopilot/autopilot.hpp"
#include "auv_dynamics/world/world.hpp"

namespace stg::dynamics {

/// The larger limit of a number of a command, by which its shares are computed.
inline double LargestOf(const Axis& axis) { return std::max(std::abs(axis.lo), std::abs(axis.hi)); }

/// The autopilots of a world's vehicles, in all lanes: the work of the controller nodes in one
/// process.
class Helm {
 public:
  /// Whether an autopilot steers the vehicles.
  static bool Steers(const VehicleConfig& vehicle);

  /// Throws UserError when no autopilot steers them.
  /// @param believed vehicle that the autopilots assume
  Helm(const VehicleConfig& vehicle, const VehicleConfig& believed, const AutopilotConfig& config,
       const RunConfig& run);

  /// An episode begins in one lane.
  void Reset(int lane);

  /// Moves the world by one decision, in periods of the autopilots.
  /// @param v_des_W [agents], desired velocity over ground, world axes [m/s]
  void Drive(const std::vector<Vec3<Pack>>& v_des_W, World* world);

  /// The last command of AUV i as shares of the limits of its actuators, at most the first
  /// kWrenchSize ones.
  void WriteShares(int i, Pack* shares) const;

 private:
  std::map<std::string, std::unique_ptr<const Autopilot>> kinds_;
  std::vector<const Autopilot*> autopilots_;  // [agents]
  std::vector<Space> actuators_;              // [agents]
  std::size_t states_ = 0, inputs_;           // numbers of a row
  int steps_, periods_;
  double dt_s_;
  std::vector<Pack> state_;     // [agents, states_]
  std::vector<Pack> commands_;  // [agents, inputs_]
};

}  // namespace stg::dynamics

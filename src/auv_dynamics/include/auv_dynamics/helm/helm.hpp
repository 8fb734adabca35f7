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

/// The larger of the limits of a command's number: its shares are shares of this.
inline double LargestOf(const Axis& axis) { return std::max(std::abs(axis.lo), std::abs(axis.hi)); }

/// The autopilots of a world's vehicles, in all lanes: what a controller node of each AUV does, in
/// one process.
class Helm {
 public:
  /// Whether vehicles are steered by an autopilot, not by force and moment.
  static bool Steers(const VehicleConfig& vehicle);

  /// Throws UserError when they are not.
  /// @param believed what the autopilots take the vehicle for
  Helm(const VehicleConfig& vehicle, const VehicleConfig& believed, const AutopilotConfig& config,
       const RunConfig& run);

  /// An episode begins in one lane.
  void Reset(int lane);

  /// Moves the world by one decision, in periods of the autopilots.
  /// @param v_des_W [agents], desired velocity over ground, world axes [m/s]
  void Drive(const std::vector<Vec3<Pack>>& v_des_W, World* world);

  /// The last command of AUV i as shares of what its actuators can do: of the first kWrenchSize of
  /// them, as many numbers as they are.
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

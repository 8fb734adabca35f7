#pragma once

#include <auv_msgs/AcousticReception.h>
#include <auv_msgs/TargetDetection.h>

#include <map>
#include <vector>

#include "auv_common/nodes/health.hpp"
#include "stg_agent/agent/agent.hpp"

namespace stg::nodes {

/// What one agent has to decide on: detections and reception windows, checked. There
/// is room for a hundred of each, whatever their stamps; where it ends, the latest window goes, as
/// it is needed last, if it is true at all.
class PendingInputs {
 public:
  /// @param id of the AUV. @param targets of the scenario
  PendingInputs(int id, int targets) : id_(id), targets_(targets) {}

  /// A detection in the sensors' frame of clock time `now`; one of the future is refused.
  void Keep(const auv_msgs::TargetDetection& message, TimeNs now);
  /// A window of the AUV's own modem.
  void Keep(const auv_msgs::AcousticReception::ConstPtr& message);

  /// Gives an agent all of the episode since clock time `start` up to `now`, receptions first.
  void Give(TimeNs start, TimeNs now, agent::Agent* agent);
  /// Forgets all of it.
  void Clear();

  /// Windows that the node itself refuses count here, too.
  Refusals& refused_receptions() { return refused_receptions_; }
  void Report(diagnostic_updater::DiagnosticStatusWrapper* status);

 private:
  int id_, targets_;
  std::vector<dynamics::Detection> detections_;  ///< with clock time
  /// By clock time of the window's end [ns].
  std::multimap<TimeNs, auv_msgs::AcousticReception::ConstPtr> receptions_;
  Refusals refused_detections_, refused_receptions_;
};

}  // namespace stg::nodes

#pragma once

#include <auv_msgs/AcousticReception.h>
#include <auv_msgs/TargetDetection.h>

#include <cstdint>
#include <map>
#include <vector>

#include "auv_common/nodes/health.hpp"
#include "stg_agent/agent/agent.hpp"

namespace stg::nodes {

/// Checked input for an agent's next decisions: detections and reception windows. It keeps up to a
/// hundred of each, with any stamps. When it is full, it drops the window with the latest stamp,
/// because that one is needed last.
class PendingInputs {
 public:
  /// @param id of the AUV. @param targets of the scenario. @param labelled detections name them
  PendingInputs(int id, int targets, bool labelled)
      : id_(id), targets_(targets), labelled_(labelled) {}

  /// Takes a detection from the sensor frame of clock time `now`; a later stamp is refused.
  void Keep(const auv_msgs::TargetDetection& message, TimeNs now);
  /// Takes a reception window of the AUV's own modem.
  void Keep(const auv_msgs::AcousticReception::ConstPtr& message);

  /// Passes to an agent all input of the episode from clock time `start` to `now`, receptions
  /// first.
  void Give(TimeNs start, TimeNs now, agent::Agent* agent);
  /// Drops all input.
  void Clear();

  /// Also counts windows that the node itself refuses.
  Refusals& refused_receptions() { return refused_receptions_; }
  void Report(diagnostic_updater::DiagnosticStatusWrapper* status);

 private:
  bool Names(std::uint32_t target) const;

  int id_, targets_;
  bool labelled_;
  std::vector<dynamics::Detection> detections_;  ///< with clock time
  /// By clock time of the window's end [ns].
  std::multimap<TimeNs, auv_msgs::AcousticReception::ConstPtr> receptions_;
  Refusals refused_detections_, refused_receptions_;
};

}  // namespace stg::nodes

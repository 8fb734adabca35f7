#include "pending_inputs.hpp"

#include <iterator>

#include "acoustic_channel/nodes/conversions.hpp"
#include "acoustic_channel/nodes/topics.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

// Most messages that are kept for a step that may never come.
constexpr std::size_t kMaxPending = 100;

}  // namespace

/// Whether this is how a detection of this scenario names its target.
bool PendingInputs::Names(std::uint32_t target) const {
  if (!labelled_) return target == auv_msgs::TargetDetection::UNLABELLED;
  return target < static_cast<std::uint32_t>(targets_);
}

void PendingInputs::Keep(const auv_msgs::TargetDetection& message, TimeNs now) {
  if (message.header.frame_id != frames::kWorld) {
    refused_detections_.Add(Refusals::kFrame);
  } else if (!UsableDetection(message)) {
    refused_detections_.Add(Refusals::kNotFinite);
  } else if (!Names(message.target) || detections_.size() >= kMaxPending) {
    refused_detections_.Add(Refusals::kMalformed);
  } else if (NsOf(message.header.stamp) > now) {
    refused_detections_.Add(Refusals::kStale);
  } else {
    detections_.push_back(DetectionOf(message));
  }
}

void PendingInputs::Keep(const auv_msgs::AcousticReception::ConstPtr& message) {
  if (message->packets.empty()) return;
  receptions_.emplace(NsOf(message->header.stamp), message);
  if (receptions_.size() <= kMaxPending) return;
  receptions_.erase(std::prev(receptions_.end()));
  refused_receptions_.Add(Refusals::kMalformed);
}

void PendingInputs::Give(TimeNs start, TimeNs now, agent::Agent* agent) {
  const auto taken = receptions_.upper_bound(now);
  for (auto it = receptions_.upper_bound(start); it != receptions_.end() && it != taken; ++it) {
    for (const auto& packet : it->second->packets) {
      const acoustics::Reception reception = ReceptionOf(packet, id_, start);
      if (reception.arrival < 0 || reception.arrival > now - start) {
        refused_receptions_.Add(Refusals::kStale);
      } else {
        agent->Receive(reception);
      }
    }
  }
  receptions_.erase(receptions_.begin(), taken);
  for (dynamics::Detection& detection : detections_) {
    if (detection.stamp < start || detection.stamp > now) continue;
    detection.stamp -= start;
    agent->Detect(detection);
  }
  detections_.clear();
}

void PendingInputs::Clear() {
  detections_.clear();
  receptions_.clear();
}

void PendingInputs::Report(diagnostic_updater::DiagnosticStatusWrapper* status) {
  refused_detections_.Report(topics::kTargetDetection, status);
  refused_receptions_.Report(topics::kAcousticRx, status);
}

}  // namespace stg::nodes

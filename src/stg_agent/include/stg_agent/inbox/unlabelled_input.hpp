#pragma once

#include <array>
#include <memory>
#include <vector>

#include "stg_agent/estimation/association.hpp"
#include "stg_agent/estimation/target_filter.hpp"
#include "stg_agent/inbox/confirmation.hpp"
#include "stg_agent/inbox/initiation.hpp"

namespace stg::agent {

/// Gives detections that do not say which target they are of to the filters of one AUV
/// (sensing.labelled: false), its own ones and those that others share.
///
/// The detections of one AUV at one time are a look. Looks are taken in the order of time. In each,
/// a target gets at most one detection, the one that LookAssignment gives it; the others are
/// dropped. It counts with the probability that it is of this target. A shared measurement contains
/// the target to which its sender assigned it. This AUV uses that target only if it has no estimate
/// of it. So AUVs that have exchanged two targets do not disturb each other's estimates. If an
/// estimate is missing, own detections without a target can start it (Initiation).
///
/// The result does not depend on the order of input between two calls of Give. It allocates nothing
/// after construction.
class UnlabelledInput {
 public:
  using Filters = std::vector<std::unique_ptr<TargetFilter>>;

  /// @param self index of the AUV
  UnlabelledInput(const AgentModel& model, int self);

  void Clear();
  /// Takes an own detection.
  void Detect(const dynamics::Detection& detection);
  /// Takes the measurements in a packet. Later packets may repeat one.
  void Hear(const NeighbourState& packet);
  /// Gives all input up to now to the filters, one filter for each target.
  void Give(TimeNs now, Filters* filters);

  /// Time of the newest own detection that a target got; -1: none.
  TimeNs own_detection(int target) const {
    return own_detections_[static_cast<std::size_t>(target)];
  }

 private:
  static constexpr std::size_t kMostPending = 512;
  static constexpr std::size_t kMostHeard = 64;  // of one AUV, which its later packets may repeat
  struct Input {
    dynamics::Detection detection;
    int source;
  };
  struct Heard {
    std::vector<dynamics::Detection> ring;
    std::size_t next = 0;
  };
  static bool Before(const Input& a, const Input& b);
  bool Same(const dynamics::Detection& a, const dynamics::Detection& b) const;
  void GiveLook(const Input* look, int count, Filters* filters);
  /// @param rivals see TargetFilter::Assign
  /// @param starts it is one of those that start an estimate, which support each other
  void Take(int target, const Input& input, double rivals, Filters* filters, bool starts = false);
  void StartMissing(const dynamics::Detection* free, int count, Filters* filters);

  int self_;
  TimeNs same_;  // two measurements of one number that are closer than this are the same
  std::vector<Input> pending_;
  std::vector<Heard> heard_;  // [agents]
  LookAssignment assignment_;
  Initiation initiation_;
  std::vector<Confirmation> confirmations_;  // [targets]
  std::array<TimeNs, dynamics::kMostTargets> own_detections_{};
};

}  // namespace stg::agent

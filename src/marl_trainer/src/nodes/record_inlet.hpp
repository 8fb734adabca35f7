#pragma once

#include <auv_msgs/AgentStep.h>
#include <auv_msgs/StepReport.h>

#include <cstdint>
#include <string>
#include <vector>

#include "marl_trainer/learn/recorded/recorded.hpp"

namespace stg::nodes {

/// Turns the messages of one source, live or from a bag, into episodes.
class RecordInlet {
 public:
  RecordInlet(const RunConfig& run, const std::string& source);

  /// @param agent index of the AUV of the message's topic.
  void Add(int agent, const auv_msgs::AgentStep& message);
  void Add(const auv_msgs::StepReport& message);

  learn::EpisodeAssembler& episodes() { return episodes_; }
  /// Number of messages that belong to no AUV of the scenario.
  std::uint64_t foreign() const { return foreign_; }

 private:
  const TimeNs period_;  ///< of decisions [ns]
  const int agents_;
  learn::EpisodeAssembler episodes_;
  std::uint64_t foreign_ = 0;
};

}  // namespace stg::nodes

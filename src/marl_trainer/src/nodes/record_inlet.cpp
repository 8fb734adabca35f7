#include "record_inlet.hpp"

#include "auv_dynamics/nodes/conversions.hpp"

namespace stg::nodes {

RecordInlet::RecordInlet(const RunConfig& run, const std::string& source)
    : period_(run.decision_period()), agents_(run.agents), episodes_(run, source) {}

void RecordInlet::Add(int agent, const auv_msgs::AgentStep& m) {
  if (agent < 0 || agent >= agents_ || m.agent != static_cast<std::uint32_t>(agent)) {
    ++foreign_;
    return;
  }
  learn::AgentRecord record;
  record.layout_version = m.observation_layout;
  record.observation = m.observation;
  record.action = m.action;
  record.log_probability = m.log_probability;
  record.policy_id = m.policy_id;
  const TimeNs start = NsOf(m.header.stamp) - static_cast<TimeNs>(m.step) * period_;
  episodes_.Add(m.episode, start, m.step, agent, std::move(record));
}

void RecordInlet::Add(const auv_msgs::StepReport& m) {
  learn::RewardRecord record;
  record.state = m.global_state;
  record.final_state = m.final_state;
  record.reward = m.reward;
  record.truncated = m.truncated;
  const TimeNs start = NsOf(m.header.stamp) - (static_cast<TimeNs>(m.step) + 1) * period_;
  episodes_.Add(m.episode, start, m.step, std::move(record));
}

}  // namespace stg::nodes

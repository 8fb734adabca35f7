#pragma once

#include <auv_msgs/EntityStep.h>
#include <auv_msgs/SwarmState.h>
#include <auv_msgs/TaskState.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "marl_trainer/learn/recorded/open_episodes.hpp"
#include "marl_trainer/learn/swarm/swarm_recording.hpp"
#include "stg_env/nodes/episode_judge.hpp"

namespace stg::nodes {

/// Turns the messages of a run into episodes of a swarm. It computes rewards and tracking by the
/// judge of the metrics node, with the reward of the given scenario.
class SwarmInlet {
 public:
  SwarmInlet(const task::JudgeConfig& scenario, const std::string& source);

  void Add(const auv_msgs::SwarmState::ConstPtr& message);
  /// @param agent index of the AUV of the message's topic.
  void Add(int agent, const auv_msgs::TaskState::ConstPtr& message);
  void Add(int agent, const auv_msgs::EntityStep::ConstPtr& message);

  /// See learn::OpenEpisodes.
  std::vector<learn::SwarmEpisode> TakeDone();
  /// Number of messages that do not fit the scenario.
  std::uint64_t foreign() const { return foreign_; }

 private:
  /// The messages of one episode, by step.
  struct Recording {
    std::uint32_t number = 0;
    std::uint64_t heard = 0;
    std::map<std::uint32_t, auv_msgs::SwarmState::ConstPtr> truth;
    std::vector<std::map<std::uint32_t, auv_msgs::TaskState::ConstPtr>> tasks;      // [agents]
    std::vector<std::map<std::uint32_t, auv_msgs::EntityStep::ConstPtr>> commands;  // [agents]
  };

  template <class Message>
  Recording* At(const Message& message);
  bool Usable(const auv_msgs::SwarmState& m) const;
  bool Usable(const auv_msgs::TaskState& m) const;
  bool Complete(const Recording& recording) const;
  learn::SwarmEpisode EpisodeOf(const Recording& recording);
  learn::Finding FindGap(const Recording& recording) const;
  learn::SwarmMoment MomentOf(const SwarmFrame& frame);

  const task::JudgeConfig scenario_;
  const std::string source_;
  const TimeNs period_;                    ///< of decisions [ns]
  const std::uint32_t steps_, decisions_;  ///< of an episode; of a command
  learn::OpenEpisodes<Recording> open_;
  EpisodeJudge judge_;
  std::uint64_t foreign_ = 0;
};

}  // namespace stg::nodes

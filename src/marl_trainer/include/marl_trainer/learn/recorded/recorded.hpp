#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "auv_dynamics/measurements.hpp"
#include "marl_trainer/learn/recorded/open_episodes.hpp"
#include "stg_agent/policy/policy.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::learn {

/// Reason why an episode cannot be used for learning.
enum class Flaw {
  kNone,
  kUnfinished,      ///< its last step was not recorded
  kGap,             ///< an agent's step is missing
  kNoReward,        ///< a step's reward and true state are missing
  kContradiction,   ///< one step was recorded twice, differently
  kObservation,     ///< another layout or size of the observation
  kAction,          ///< another number of action components
  kState,           ///< another size of the true state
  kNotFinite,       ///< NaN or infinity
  kForeignPolicy,   ///< sampled by another policy than the one to train
  kLogProbability,  ///< the policy computes another probability for the action
  kCount,
};
const char* ToString(Flaw flaw);

/// A flaw and its place, for messages.
struct Finding {
  Flaw flaw = Flaw::kNone;
  std::string where;
};

/// One recorded decision of one agent.
struct AgentRecord {
  std::uint32_t layout_version = 0;
  std::vector<float> observation;  ///< raw
  std::vector<float> action;       ///< before clipping
  float log_probability = 0.0F;
  std::string policy_id;
  bool operator==(const AgentRecord& other) const;
};

/// Result of one decision step of the swarm.
struct RewardRecord {
  std::vector<float> state, final_state;  ///< raw, for the critic; final_state only where truncated
  double reward = 0.0;                    ///< mean over agents
  bool truncated = false;
  bool operator==(const RewardRecord& other) const;
};

/// One episode, as far as it was recorded.
struct RecordedEpisode {
  std::uint32_t number = 0;
  std::string source;  ///< bag file, or name of the live source
  std::vector<std::map<std::uint32_t, AgentRecord>> steps;  ///< [agent], by step
  std::map<std::uint32_t, RewardRecord> rewards;            ///< by step
  Finding finding;          ///< flaw that was found while it was assembled
  std::uint64_t heard = 0;  ///< number of the source's last message about it

  bool Complete(int episode_steps) const;
};

/// Assembles episodes from the messages of one source.
class EpisodeAssembler {
 public:
  EpisodeAssembler(const RunConfig& run, std::string source);

  /// @param start time of the episode's step 0. @param agent in [0, agents).
  void Add(std::uint32_t episode, TimeNs start, std::uint32_t step, int agent, AgentRecord record);
  void Add(std::uint32_t episode, TimeNs start, std::uint32_t step, RewardRecord record);

  /// See OpenEpisodes.
  std::vector<RecordedEpisode> TakeDone();
  std::vector<RecordedEpisode> TakeAll() { return open_.TakeAll(); }
  std::uint64_t late() const { return open_.late(); }

 private:
  /// The episode; null: it has been taken already.
  RecordedEpisode* At(std::uint32_t episode, TimeNs start);

  const int agents_, episode_steps_;
  const std::string source_;
  OpenEpisodes<RecordedEpisode> open_;
};

/// Checks episodes for on-policy learning with one policy in one scenario.
class EpisodeChecker {
 public:
  /// Largest allowed difference between a recorded log probability and the policy's own.
  static constexpr double kLogProbabilityTolerance = 1e-3;

  /// @param policy must outlive this object and fit the scenario.
  EpisodeChecker(const RunConfig& run, const agent::ObservationConfig& observation, int state_size,
                 const agent::Policy& policy);
  /// The first flaw; kNone if the episode can be used for learning.
  Finding Check(const RecordedEpisode& episode) const;

 private:
  Finding CheckStep(const AgentRecord& record) const;
  Finding CheckReward(const RewardRecord& record) const;
  double LogProbability(const AgentRecord& record) const;

  const int agents_, episode_steps_, state_size_;
  const std::uint32_t layout_version_;
  const agent::Policy& policy_;
};

/// Version of ObservationLayout(): 1 for "stg-1:...".
std::uint32_t LayoutVersion(const agent::ObservationConfig& observation);

/// Numbers of used episodes and of dropped ones by reason.
struct RecordingReport {
  std::uint64_t used = 0, unreadable_sources = 0, foreign_messages = 0;
  std::array<std::uint64_t, static_cast<std::size_t>(Flaw::kCount)> dropped{};
  std::uint64_t total_dropped() const;
  /// "3 episodes used, 2 dropped (1 gap, 1 NaN or infinity)".
  std::string Text() const;
};

}  // namespace stg::learn

#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "auv_dynamics/measurements.hpp"
#include "stg_agent/policy/policy.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::learn {

/// Why an episode cannot be learnt from.
enum class Flaw {
  kNone,
  kUnfinished,      ///< its last step was not recorded
  kGap,             ///< an agent's step is missing
  kNoReward,        ///< a step's reward and true state are missing
  kContradiction,   ///< one step was recorded twice, differently
  kObservation,     ///< another observation layout or size
  kAction,          ///< another number of action components
  kState,           ///< another size of the true state
  kNotFinite,       ///< NaN or infinity
  kForeignPolicy,   ///< sampled by another policy than the one to improve
  kLogProbability,  ///< the policy gives its action another probability
  kCount,
};
const char* ToString(Flaw flaw);

/// A flaw and where it was found; for people.
struct Finding {
  Flaw flaw = Flaw::kNone;
  std::string where;
};

/// One decision of one agent, as recorded.
struct AgentRecord {
  std::uint32_t layout_version = 0;
  std::vector<float> observation;  ///< raw
  std::vector<float> action;       ///< before clipping
  float log_probability = 0.0F;
  std::string policy_id;
  bool operator==(const AgentRecord& other) const;
};

/// What one decision step of the swarm led to.
struct RewardRecord {
  std::vector<float> state, final_state;  ///< raw, of the critic; final where truncated
  double reward = 0.0;                    ///< mean over agents
  bool truncated = false;
  bool operator==(const RewardRecord& other) const;
};

/// One episode, as far as it was recorded.
struct RecordedEpisode {
  std::uint32_t number = 0;
  std::string source;                                       ///< bag file, or how it was heard
  std::vector<std::map<std::uint32_t, AgentRecord>> steps;  ///< [agent], by step
  std::map<std::uint32_t, RewardRecord> rewards;            ///< by step
  Finding finding;          ///< what was wrong with it while it was put together
  std::uint64_t heard = 0;  ///< when the last word about it came, in words of the source

  bool Complete(int episode_steps) const;
};

/// Puts messages of one source together into episodes. An episode is known by its number and by
/// when its step 0 was, so that two runs in one bag do not mix.
class EpisodeAssembler {
 public:
  EpisodeAssembler(const RunConfig& run, std::string source);

  /// @param start time of the episode's step 0. @param agent in [0, agents).
  void Add(std::uint32_t episode, TimeNs start, std::uint32_t step, int agent, AgentRecord record);
  void Add(std::uint32_t episode, TimeNs start, std::uint32_t step, RewardRecord record);

  /// Takes complete episodes, oldest first; and of the others all but the two that were heard of
  /// last, whatever their stamps say: they are not going to be completed any more. What is said
  /// later about an episode that has been taken is ignored.
  std::vector<RecordedEpisode> TakeDone();
  /// Takes all there is: the source has ended.
  std::vector<RecordedEpisode> TakeAll();

  /// Records of episodes that had been taken.
  std::uint64_t late() const { return late_; }

 private:
  using Key = std::pair<TimeNs, std::uint32_t>;
  /// Null: it has been taken.
  RecordedEpisode* At(std::uint32_t episode, TimeNs start);
  void Forget(const Key& key);

  const int agents_, episode_steps_;
  const std::string source_;
  std::map<Key, RecordedEpisode> episodes_;
  std::set<Key> taken_;
  std::deque<Key> taken_in_order_;  ///< the same, to forget the first ones
  std::uint64_t heard_ = 0, late_ = 0;
};

/// Judges episodes for on-policy learning with one policy in one scenario.
class EpisodeChecker {
 public:
  /// Largest deviation of a recorded log probability from the policy's own.
  static constexpr double kLogProbabilityTolerance = 1e-3;

  /// @param policy must outlive this object, and fit the scenario.
  EpisodeChecker(const RunConfig& run, const agent::ObservationConfig& observation, int state_size,
                 const agent::Policy& policy);
  /// The first flaw found, kNone for an episode to learn from.
  Finding Check(const RecordedEpisode& episode) const;

 private:
  Finding CheckStep(const AgentRecord& record) const;
  Finding CheckReward(const RewardRecord& record) const;
  double LogProbability(const AgentRecord& record) const;

  const int agents_, episode_steps_, state_size_;
  const std::uint32_t layout_version_;
  const agent::Policy& policy_;
};

/// Version in ObservationLayout(): 1 for "stg-1:...".
std::uint32_t LayoutVersion(const agent::ObservationConfig& observation);

/// How many episodes were used, and dropped for which reason.
struct RecordingReport {
  std::uint64_t used = 0, unreadable_sources = 0, foreign_messages = 0;
  std::array<std::uint64_t, static_cast<std::size_t>(Flaw::kCount)> dropped{};
  std::uint64_t total_dropped() const;
  /// "3 episodes used, 2 dropped (1 gap, 1 NaN or infinity)".
  std::string Text() const;
};

}  // namespace stg::learn

#include "marl_trainer/learn/recorded/recorded.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {
namespace {

/// With this comparison, NaN equals itself, and the two zeros differ.
template <class T>
bool SameBits(T a, T b) {
  return std::memcmp(&a, &b, sizeof a) == 0;  // NOLINT(bugprone-suspicious-memory-comparison)
}

bool SameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
}

bool Finite(const std::vector<float>& x) {
  return std::all_of(x.begin(), x.end(), [](float v) { return std::isfinite(v); });
}

std::string Counted(const char* what, std::size_t is, std::size_t wanted) {
  return std::string(what) + " has " + std::to_string(is) + " numbers, not " +
         std::to_string(wanted);
}

std::string At(std::uint32_t step, int agent) {
  return "AUV " + std::to_string(agent) + ", step " + std::to_string(step);
}

}  // namespace

const char* ToString(Flaw flaw) {
  switch (flaw) {
    case Flaw::kNone:
      return "none";
    case Flaw::kUnfinished:
      return "unfinished";
    case Flaw::kGap:
      return "steps missing";
    case Flaw::kNoReward:
      return "rewards missing";
    case Flaw::kContradiction:
      return "contradictory steps";
    case Flaw::kObservation:
      return "another observation layout";
    case Flaw::kAction:
      return "another action size";
    case Flaw::kState:
      return "another state size";
    case Flaw::kNotFinite:
      return "NaN or infinity";
    case Flaw::kForeignPolicy:
      return "another policy";
    case Flaw::kLogProbability:
      return "wrong log probability";
    case Flaw::kCount:
      break;
  }
  return "";
}

bool AgentRecord::operator==(const AgentRecord& other) const {
  return layout_version == other.layout_version && policy_id == other.policy_id &&
         SameBits(log_probability, other.log_probability) &&
         SameBits(observation, other.observation) && SameBits(action, other.action);
}

bool RewardRecord::operator==(const RewardRecord& other) const {
  return truncated == other.truncated && SameBits(reward, other.reward) &&
         SameBits(state, other.state) && SameBits(final_state, other.final_state);
}

bool RecordedEpisode::Complete(int episode_steps) const {
  const auto all = static_cast<std::size_t>(episode_steps);
  return rewards.size() >= all &&
         std::all_of(steps.begin(), steps.end(), [all](const auto& s) { return s.size() >= all; });
}

EpisodeAssembler::EpisodeAssembler(const RunConfig& run, std::string source)
    : agents_(run.agents), episode_steps_(run.time.episode_steps), source_(std::move(source)) {}

RecordedEpisode* EpisodeAssembler::At(std::uint32_t episode, TimeNs start) {
  return open_.At(episode, start, [&] {
    RecordedEpisode e;
    e.number = episode;
    e.source = source_;
    e.steps.resize(static_cast<std::size_t>(agents_));
    return e;
  });
}

void EpisodeAssembler::Add(std::uint32_t episode, TimeNs start, std::uint32_t step, int agent,
                           AgentRecord record) {
  // The decision on the last observation of an episode has no effect, because the world restarts.
  if (step >= static_cast<std::uint32_t>(episode_steps_)) return;
  RecordedEpisode* const e = At(episode, start);
  if (e == nullptr) return;
  const auto [place, added] = e->steps[static_cast<std::size_t>(agent)].try_emplace(step, record);
  if (!added && !(place->second == record)) {
    e->finding = {Flaw::kContradiction, learn::At(step, agent)};
  }
}

void EpisodeAssembler::Add(std::uint32_t episode, TimeNs start, std::uint32_t step,
                           RewardRecord record) {
  RecordedEpisode* const e = At(episode, start);
  if (e == nullptr) return;
  if (step >= static_cast<std::uint32_t>(episode_steps_)) {
    e->finding = {Flaw::kContradiction, "a reward of step " + std::to_string(step) +
                                            ", past the scenario's " +
                                            std::to_string(episode_steps_) + " steps"};
    return;
  }
  const auto [place, added] = e->rewards.try_emplace(step, record);
  if (!added && !(place->second == record)) {
    e->finding = {Flaw::kContradiction, "reward of step " + std::to_string(step)};
  }
}

std::vector<RecordedEpisode> EpisodeAssembler::TakeDone() {
  return open_.TakeDone([this](const RecordedEpisode& e) { return e.Complete(episode_steps_); });
}

EpisodeChecker::EpisodeChecker(const RunConfig& run, const agent::ObservationConfig& observation,
                               int state_size, const agent::Policy& policy)
    : agents_(run.agents),
      episode_steps_(run.time.episode_steps),
      state_size_(state_size),
      layout_version_(LayoutVersion(observation)),
      policy_(policy) {}

Finding EpisodeChecker::Check(const RecordedEpisode& episode) const {
  if (episode.finding.flaw != Flaw::kNone) return episode.finding;
  const auto last = static_cast<std::uint32_t>(episode_steps_ - 1);
  const auto end = episode.rewards.find(last);
  const bool ended = end != episode.rewards.end() && end->second.truncated;
  // Missing steps after the end of a recording are not a gap.
  if (!ended) return {Flaw::kUnfinished, "the end of the episode is missing"};
  for (std::uint32_t t = 0; t <= last; ++t) {
    const auto reward = episode.rewards.find(t);
    if (reward == episode.rewards.end()) return {Flaw::kNoReward, "step " + std::to_string(t)};
    Finding finding = CheckReward(reward->second);
    if (finding.flaw == Flaw::kNone && reward->second.truncated != (t == last)) {
      finding = {Flaw::kContradiction, "the episode ends early"};
    }
    if (finding.flaw != Flaw::kNone) {
      return {finding.flaw, "step " + std::to_string(t) + ": " + finding.where};
    }
    for (int i = 0; i < agents_; ++i) {
      const auto& steps = episode.steps[static_cast<std::size_t>(i)];
      const auto step = steps.find(t);
      if (step == steps.end()) return {Flaw::kGap, At(t, i)};
      finding = CheckStep(step->second);
      if (finding.flaw != Flaw::kNone) return {finding.flaw, At(t, i) + ": " + finding.where};
    }
  }
  return {};
}

Finding EpisodeChecker::CheckReward(const RewardRecord& r) const {
  const auto size = static_cast<std::size_t>(state_size_);
  if (r.state.size() != size) return {Flaw::kState, Counted("state", r.state.size(), size)};
  if (r.truncated && r.final_state.size() != size) {
    return {Flaw::kState, Counted("final state", r.final_state.size(), size)};
  }
  if (!std::isfinite(static_cast<float>(r.reward)) || !Finite(r.state) || !Finite(r.final_state)) {
    return {Flaw::kNotFinite, "reward or state"};
  }
  return {};
}

Finding EpisodeChecker::CheckStep(const AgentRecord& r) const {
  const auto inputs = static_cast<std::size_t>(policy_.observation_size());
  const auto outputs = static_cast<std::size_t>(policy_.action_size());
  if (r.layout_version != layout_version_) {
    return {Flaw::kObservation, "layout version " + std::to_string(r.layout_version) + ", not " +
                                    std::to_string(layout_version_)};
  }
  if (r.observation.size() != inputs) {
    return {Flaw::kObservation, Counted("observation", r.observation.size(), inputs)};
  }
  if (r.action.size() != outputs) {
    return {Flaw::kAction, Counted("action", r.action.size(), outputs)};
  }
  if (!Finite(r.observation) || !Finite(r.action) || !std::isfinite(r.log_probability)) {
    return {Flaw::kNotFinite, "observation, action or log probability"};
  }
  if (r.policy_id != policy_.metadata().id) {
    return {Flaw::kForeignPolicy,
            "'" + r.policy_id.substr(0, 80) + "', not '" + policy_.metadata().id + "'"};
  }
  const double expected = LogProbability(r);
  if (!(std::abs(expected - static_cast<double>(r.log_probability)) <= kLogProbabilityTolerance)) {
    return {Flaw::kLogProbability,
            std::to_string(r.log_probability) + ", not " + std::to_string(expected)};
  }
  return {};
}

/// Natural log of the policy's Gaussian density (Eq. 37) at the recorded action.
double EpisodeChecker::LogProbability(const AgentRecord& r) const {
  std::vector<float> mean(r.action.size());
  policy_.Mean(r.observation.data(), mean.data());
  return agent::GaussianLogDensity(mean.data(), policy_.parameters().log_std.data(),
                                   r.action.data(), static_cast<int>(mean.size()));
}

std::uint32_t LayoutVersion(const agent::ObservationConfig& observation) {
  const std::string layout = agent::ObservationLayout(observation);
  return static_cast<std::uint32_t>(
      std::strtoul(layout.c_str() + layout.find('-') + 1, nullptr, 10));
}

std::uint64_t RecordingReport::total_dropped() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t count : dropped) sum += count;
  return sum;
}

std::string RecordingReport::Text() const {
  std::string text = std::to_string(used) + (used == 1 ? " episode used, " : " episodes used, ") +
                     std::to_string(total_dropped()) + " dropped";
  std::string reasons;
  for (std::size_t f = 0; f < dropped.size(); ++f) {
    if (dropped[f] == 0) continue;
    if (!reasons.empty()) reasons += ", ";
    reasons += std::to_string(dropped[f]) + " " + ToString(static_cast<Flaw>(f));
  }
  if (!reasons.empty()) text += " (" + reasons + ")";
  if (unreadable_sources > 0)
    text += ", " + std::to_string(unreadable_sources) + " bags unreadable";
  if (foreign_messages > 0) {
    text += ", " + std::to_string(foreign_messages) + " messages of another type or AUV";
  }
  return text;
}

}  // namespace stg::learn

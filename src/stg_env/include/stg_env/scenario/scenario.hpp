#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stg_env/task/judge_config.hpp"

namespace stg {

/// The knowledge of agents: all true states, as in the release, or own sensing and received
/// packets.
enum class InformationMode { kTruth, kAcoustic };

/// A whole scenario: everything that a run depends on, apart from seed and policy.
struct Scenario {
  RunConfig run;
  InformationMode mode = InformationMode::kAcoustic;
  dynamics::WorldConfig world;
  acoustics::ChannelConfig channel;
  agent::AgentConfig agent;
  task::RewardConfig reward;
  task::CriticConfig critic;
  config::Differences agent_model;  ///< of agent::KeysOfModel; empty: agents know the true values

  /// The agents' model.
  agent::AgentModel model() const {
    return agent::ModelOf(run, world, channel, agent, agent_model);
  }
  /// The sections of its task.
  task::JudgeConfig judge() const { return {run, world, agent, reward, critic}; }

  /// Throws UserError naming the key when a value is out of range or two keys
  /// contradict each other.
  void ValidateOrThrow() const;
};

/// All keys, in the order of the shipped files.
void Describe(Scenario* s, config::Table* t);
/// Contradictions between its keys.
std::optional<config::Violation> FindConflict(const Scenario& s);

/// A scenario file, overlays and `key.path=value` overrides in order; see config::Loader.
Scenario LoadScenario(const std::string& file, const std::vector<std::string>& overlays = {},
                      const std::vector<std::string>& overrides = {});

/// The same from the names of config::NamedSource.
Scenario LoadNamedScenario(const std::string& folder, const std::string& scenario,
                           const std::string& condition = "nominal",
                           const std::vector<std::string>& overrides = {});

/// Throws UserError for an override "key.path=value" of a key that only a training reads: the
/// curriculum, the scales of the critic's state, and the scale of the actions, which a policy file
/// contains.
/// @param program for the message
void RefuseKeysOfTraining(const std::vector<std::string>& overrides, const std::string& program);

/// Every key with its value; LoadScenario of the result gives the same struct.
std::string ToYaml(const Scenario& scenario);

/// FNV-1a 64 of ToYaml, hexadecimal; identifies the scenario in policy files.
std::string ScenarioHash(const Scenario& scenario);

}  // namespace stg

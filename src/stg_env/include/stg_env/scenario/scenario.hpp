#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stg_env/task/judge_config.hpp"

namespace stg {

/// What agents decide on: everybody's true state (the release's way), or their own sensing and
/// what the channel brings.
enum class InformationMode { kTruth, kAcoustic };

/// All of a scenario: everything a run depends on besides a seed and a policy.
struct Scenario {
  RunConfig run;
  InformationMode mode = InformationMode::kAcoustic;
  dynamics::WorldConfig world;
  acoustics::ChannelConfig channel;
  agent::AgentConfig agent;
  task::RewardConfig reward;
  task::CriticConfig critic;
  config::Differences agent_model;  ///< of agent::KeysOfModel; empty: agents know what is true

  /// What its agents know.
  agent::AgentModel model() const {
    return agent::ModelOf(run, world, channel, agent, agent_model);
  }
  /// What its task judges by.
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

/// As LoadScenario, by the names of config::NamedSource.
Scenario LoadNamedScenario(const std::string& folder, const std::string& scenario,
                           const std::string& condition = "nominal",
                           const std::vector<std::string>& overrides = {});

/// Every key with its value; LoadScenario of the result gives the same struct.
std::string ToYaml(const Scenario& scenario);

/// FNV-1a 64 of ToYaml, hexadecimal; identifies the scenario in policy files.
std::string ScenarioHash(const Scenario& scenario);

}  // namespace stg

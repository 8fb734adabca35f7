#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "auv_common/folder_lock.hpp"
#include "marl_trainer/learn/checkpoint/checkpoint.hpp"
#include "marl_trainer/learn/train_config.hpp"
#include "stg_agent/policy/policy.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::learn {

/// The folder of a training: checkpoints, policies, and what it was started with.
class RunFolder {
 public:
  /// Creates the folder; UserError when that fails. @param log of refused checkpoints.
  RunFolder(std::string path, std::ostream* log);

  /// Keeps other programs from writing into the folder, as long as this lives; UserError when one
  /// does already. Among ranks, rank 0 calls it.
  void Lock() { lock_.emplace(path_); }

  const std::string& path() const { return path_; }
  /// Whether it has a checkpoint or a policy: a run that was ended before its first checkpoint
  /// leaves nothing worth keeping.
  bool HoldsRun() const;

  /// Writes config.json, scenario.yaml and, for a mix, train_on_<k>.yaml; UserError when that
  /// fails. @param scenario, mix as ToYaml writes them
  void WriteSetup(const nlohmann::ordered_json& config, const std::string& scenario,
                  const std::vector<std::string>& mix) const;

  std::optional<TrainState> Newest() const { return LoadNewestCheckpoint(path_, log_); }
  /// Writes a checkpoint and removes all but the newest `keep`.
  void Save(const TrainState& state, int keep) const;

  /// Writes name.onnx, or name_<i>.onnx where each AUV has a policy of its own.
  void SavePolicies(const std::vector<agent::Policy>& policies, const std::string& name) const;
  /// Absolute path of SavePolicies' file for all AUVs.
  std::string PolicyPath(const std::string& name) const;

 private:
  const std::string path_;
  std::ostream* log_;
  std::optional<FolderLock> lock_;
};

/// What a run was started with, as RunFolder::WriteSetup has written it.
struct RunSetup {
  TrainSetup setup;
  Scenario scenario;
  std::vector<Scenario> mix;  ///< empty: trained on the scenario alone
};

/// Reads a run's folder again; UserError that names the file when one is missing or damaged.
RunSetup ReadRunSetup(const std::string& folder);

/// Throws UserError, beginning with `where`, unless the checkpoint's run has the configuration
/// `ours`, except for more or fewer steps, and the same scenario.
void RequireSameRun(const TrainState& theirs, const nlohmann::ordered_json& ours,
                    const std::string& scenario, const std::string& where);

/// What every exported policy tells about itself.
/// @param scenario_hash see ScenarioHash
agent::PolicyMetadata MetadataOf(const agent::ObservationConfig& observation,
                                 const dynamics::ControlConfig& control,
                                 const std::string& scenario_hash, const std::string& id,
                                 std::int64_t training_step, std::uint64_t seed);

}  // namespace stg::learn

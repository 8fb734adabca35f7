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

/// The folder of a training: checkpoints, policies and the setup.
class RunFolder {
 public:
  /// Creates the folder. Throws UserError if this fails. @param log gets messages about refused
  /// checkpoints.
  RunFolder(std::string path, std::ostream* log);

  /// Locks the folder against other programs that write, as long as this object lives. Throws
  /// UserError if another program has locked it. Among ranks, only rank 0 calls it.
  void Lock() { lock_.emplace(path_); }

  const std::string& path() const { return path_; }
  /// True if there is a checkpoint or a policy. A run that ended before its first checkpoint left
  /// nothing worth keeping.
  bool HoldsRun() const;

  /// Writes config.json, scenario.yaml and, for a mix, train_on_<k>.yaml. Throws UserError if this
  /// fails. @param scenario, mix as ToYaml writes them
  void WriteSetup(const nlohmann::ordered_json& config, const std::string& scenario,
                  const std::vector<std::string>& mix) const;

  std::optional<TrainState> Newest() const { return LoadNewestCheckpoint(path_, log_); }
  /// Writes a checkpoint and removes all except the newest `keep`.
  void Save(const TrainState& state, int keep) const;

  /// Writes name.onnx, or name_<i>.onnx if each AUV has its own policy.
  void SavePolicies(const std::vector<agent::Policy>& policies, const std::string& name) const;
  /// Absolute path of the file that SavePolicies writes for all AUVs.
  std::string PolicyPath(const std::string& name) const;

 private:
  const std::string path_;
  std::ostream* log_;
  std::optional<FolderLock> lock_;
};

/// The setup of a run, as written by RunFolder::WriteSetup.
struct RunSetup {
  TrainSetup setup;
  Scenario scenario;
  std::vector<Scenario> mix;  ///< empty: trained on the scenario only
};

/// Reads the setup from a run's folder. Throws UserError that names the file if one is missing or
/// damaged.
RunSetup ReadRunSetup(const std::string& folder);

/// Throws UserError that begins with `where` unless the checkpoint's run has the same
/// configuration, except for the number of steps, and the same scenario.
void RequireSameRun(const TrainState& theirs, const nlohmann::ordered_json& ours,
                    const std::string& scenario, const std::string& where);

/// Metadata of an exported policy.
/// @param scenario_hash see ScenarioHash
agent::PolicyMetadata MetadataOf(const agent::ObservationConfig& observation,
                                 const dynamics::ControlConfig& control,
                                 const std::string& scenario_hash, const std::string& id,
                                 std::int64_t training_step, std::uint64_t seed);

}  // namespace stg::learn

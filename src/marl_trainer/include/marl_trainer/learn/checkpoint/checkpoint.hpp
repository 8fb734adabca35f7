#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>

#include "marl_trainer/learn/checkpoint/archive.hpp"

namespace stg::learn {

/// Everything a training run needs to go on as if it had never stopped. The environments are
/// described by the number of an episode that all of them started together and by what was done in
/// them since: they are deterministic, and random draws are counter-based and need no state.
struct TrainState {
  std::int64_t env_steps = 0;
  std::int64_t collections = 0;
  std::uint64_t round = 0;  ///< episode that all environments started together last
  double best_return = -1e300;
  double wall_seconds = 0.0;
  std::string config;    ///< ToJson(TrainSetup), text
  std::string scenario;  ///< ToYaml(Scenario)
  std::string log;       ///< TrainLog's state, JSON text
  Archive algorithm;     ///< what Algorithm::Save wrote
  Archive episodes;      ///< what Collector::Save wrote
};

/// See WriteArchive.
void SaveCheckpoint(const TrainState& state, const std::string& path);

/// Throws UserError that names the file, see ReadArchive.
TrainState LoadCheckpoint(const std::string& path);

/// Folder/checkpoint_<steps>.ckpt.
std::string CheckpointPath(const std::string& folder, std::int64_t env_steps);
/// Removes all but the newest `keep` checkpoints of the folder.
void PruneCheckpoints(const std::string& folder, int keep);
/// The newest good checkpoint of the folder; bad ones are reported to `log` and
/// passed over. Empty when there is none.
std::optional<TrainState> LoadNewestCheckpoint(const std::string& folder, std::ostream* log);
/// Whether the file is named as a checkpoint of this or an earlier version.
bool IsCheckpointName(const std::string& file_name);

}  // namespace stg::learn

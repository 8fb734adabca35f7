#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>

#include "marl_trainer/learn/checkpoint/archive.hpp"

namespace stg::learn {

/// Everything that a training run needs to continue as if it had never stopped. The environments
/// are stored as the number of the episode that all of them last started together, and their
/// actions since then. This is enough, because they are deterministic, and random draws are
/// counter-based and have no state.
struct TrainState {
  std::int64_t env_steps = 0;
  std::int64_t collections = 0;
  std::uint64_t round = 0;  ///< number of the episode that all environments last started together
  double best_return = -1e300;
  double wall_seconds = 0.0;
  std::string config;    ///< ToJson(TrainSetup), text
  std::string scenario;  ///< ToYaml(Scenario)
  std::string log;       ///< state of TrainLog, JSON text
  Archive algorithm;     ///< written by Algorithm::Save
  Archive episodes;      ///< written by Collector::Save
};

/// Goes on from a saved state, with the options of `state`. Throws UserError, which names the
/// folder, if the saved training had another scenario or if `load` refuses the algorithm's part.
void GoOnFrom(const TrainState& saved, const std::string& folder,
              const std::function<void(const Archive& algorithm)>& load, TrainState* state);

/// See WriteArchive.
void SaveCheckpoint(const TrainState& state, const std::string& path);

/// Throws UserError that names the file; see ReadArchive.
TrainState LoadCheckpoint(const std::string& path);

/// Folder/checkpoint_<steps>.ckpt.
std::string CheckpointPath(const std::string& folder, std::int64_t env_steps);
/// Removes all checkpoints of the folder except the newest `keep`.
void PruneCheckpoints(const std::string& folder, int keep);
/// The newest good checkpoint of the folder; empty if there is none. Bad ones are reported in `log`
/// and skipped.
std::optional<TrainState> LoadNewestCheckpoint(const std::string& folder, std::ostream* log);
/// True if the file has the name of a checkpoint of this or an earlier version.
bool IsCheckpointName(const std::string& file_name);

}  // namespace stg::learn

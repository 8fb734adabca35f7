#include "marl_trainer/learn/checkpoint/checkpoint.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "auv_common/error.hpp"

namespace stg::learn {
namespace {

namespace fs = std::filesystem;

/// Checkpoints of a folder, newest first.
std::vector<fs::path> Checkpoints(const std::string& folder) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (IsCheckpointName(entry.path().filename().string())) found.push_back(entry.path());
  }
  std::sort(found.rbegin(), found.rend());
  return found;
}

TrainState FromArchive(const Archive& archive) {
  TrainState s;
  s.env_steps = archive.Count("env_steps");
  s.collections = archive.Count("collections");
  s.round = static_cast<std::uint64_t>(archive.Count("round"));
  s.best_return = archive.Number("best_return");
  s.wall_seconds = archive.Number("wall_seconds");
  if (s.wall_seconds < 0.0) throw UserError("'wall_seconds' is negative");
  s.config = archive.Text("config");
  s.scenario = archive.Text("scenario");
  s.log = archive.Text("log");
  s.algorithm = archive.Part("algorithm");
  s.episodes = archive.Part("episodes");
  return s;
}

}  // namespace

bool IsCheckpointName(const std::string& file_name) {
  // Version 1 ended in .pt. Its files are found, so that the message that refuses them names them.
  const std::string extension = fs::path(file_name).extension().string();
  return file_name.rfind("checkpoint_", 0) == 0 && (extension == ".ckpt" || extension == ".pt");
}

void GoOnFrom(const TrainState& saved, const std::string& folder,
              const std::function<void(const Archive& algorithm)>& load, TrainState* state) {
  if (saved.scenario != state->scenario) {
    throw UserError(folder + ": holds a training in another scenario");
  }
  try {
    load(saved.algorithm);
  } catch (const UserError& error) {
    throw UserError(folder + ": holds another training: " + error.what());
  }
  const std::string config = state->config;
  *state = saved;
  state->config = config;
  state->algorithm = Archive();  // the algorithm itself holds it now
}

void SaveCheckpoint(const TrainState& s, const std::string& path) {
  Archive archive;
  archive.PutInteger("env_steps", s.env_steps);
  archive.PutInteger("collections", s.collections);
  archive.PutInteger("round", static_cast<std::int64_t>(s.round));
  archive.PutNumber("best_return", s.best_return);
  archive.PutNumber("wall_seconds", s.wall_seconds);
  archive.Put("config", s.config);
  archive.Put("scenario", s.scenario);
  archive.Put("log", s.log);
  archive.PutPart("algorithm", s.algorithm);
  archive.PutPart("episodes", s.episodes);
  WriteArchive(archive, path);
}

TrainState LoadCheckpoint(const std::string& path) {
  const Archive archive = ReadArchive(path);
  try {
    return FromArchive(archive);
  } catch (const UserError& error) {
    throw UserError(path + ": not a checkpoint of a training: " + error.what());
  }
}

std::string CheckpointPath(const std::string& folder, std::int64_t env_steps) {
  char name[48];
  std::snprintf(name, sizeof name, "checkpoint_%012" PRId64 ".ckpt", env_steps);
  return (fs::path(folder) / name).string();
}

void PruneCheckpoints(const std::string& folder, int keep) {
  const std::vector<fs::path> found = Checkpoints(folder);
  std::error_code ignored;
  for (std::size_t i = static_cast<std::size_t>(keep); i < found.size(); ++i) {
    fs::remove(found[i], ignored);
  }
}

std::optional<TrainState> LoadNewestCheckpoint(const std::string& folder, std::ostream* log) {
  for (const fs::path& path : Checkpoints(folder)) {
    try {
      return LoadCheckpoint(path.string());
    } catch (const UserError& error) {
      *log << "refused " << error.what() << "; trying the previous one" << std::endl;
    }
  }
  return std::nullopt;
}

}  // namespace stg::learn

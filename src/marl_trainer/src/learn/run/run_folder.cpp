#include "marl_trainer/learn/run/run_folder.hpp"

#include <filesystem>
#include <utility>

#include "auv_common/config/yaml_tree.hpp"
#include "auv_common/durable_file.hpp"
#include "auv_common/error.hpp"

namespace stg::learn {
namespace {

namespace fs = std::filesystem;

std::string MixFile(std::size_t k) { return "train_on_" + std::to_string(k) + ".yaml"; }

void WriteScenario(const fs::path& file, const std::string& yaml) {
  WriteDurably(yaml, file.string(), "the scenario");
}

}  // namespace

RunFolder::RunFolder(std::string path, std::ostream* log) : path_(std::move(path)), log_(log) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (!error && fs::is_directory(path_, error)) fs::directory_iterator readable(path_, error);
  if (error) throw UserError(path_ + ": cannot be used as the folder of a run: " + error.message());
}

bool RunFolder::HoldsRun() const {
  for (const auto& entry : fs::directory_iterator(path_)) {
    if (entry.path().extension() == ".onnx" || IsCheckpointName(entry.path().filename().string())) {
      return true;
    }
  }
  return false;
}

void RunFolder::WriteSetup(const nlohmann::ordered_json& config, const std::string& scenario,
                           const std::vector<std::string>& mix) const {
  const fs::path folder(path_);
  WriteDurably(config.dump(2) + "\n", (folder / "config.json").string(), "the configuration");
  WriteScenario(folder / "scenario.yaml", scenario);
  for (std::size_t k = 0; k < mix.size(); ++k) WriteScenario(folder / MixFile(k), mix[k]);
}

void RunFolder::Save(const TrainState& state, int keep) const {
  SaveCheckpoint(state, CheckpointPath(path_, state.env_steps));
  PruneCheckpoints(path_, keep);
}

void RunFolder::SavePolicies(const std::vector<agent::Policy>& policies,
                             const std::string& name) const {
  for (std::size_t i = 0; i < policies.size(); ++i) {
    policies[i].SaveOnnx(PolicyPath(policies.size() == 1 ? name : name + "_" + std::to_string(i)));
  }
}

std::string RunFolder::PolicyPath(const std::string& name) const {
  return fs::absolute(fs::path(path_) / (name + ".onnx")).string();
}

RunSetup ReadRunSetup(const std::string& folder) {
  const fs::path file = fs::path(folder) / "config.json";
  std::error_code error;
  if (!fs::exists(file, error)) {
    throw UserError(folder + ": no run to resume: it has no config.json");
  }
  const auto json =
      nlohmann::ordered_json::parse(config::ReadBoundedFile(file.string()), nullptr, false);
  if (!json.is_object()) throw UserError(file.string() + ": not the configuration of a training");
  const auto setup = [&] {
    try {
      TrainSetup read = TrainSetupFromJson(json);
      read.ValidateOrThrow();
      return read;
    } catch (const UserError& error) {
      throw UserError(file.string() + ": " + error.what());
    }
  };
  const auto scenario = [&](const std::string& name) {
    return LoadScenario((fs::path(folder) / name).string());
  };
  RunSetup run{setup(), scenario("scenario.yaml"), {}};
  for (std::size_t k = 0; fs::exists(fs::path(folder) / MixFile(k)); ++k) {
    run.mix.push_back(scenario(MixFile(k)));
  }
  return run;
}

void RequireSameRun(const TrainState& state, const nlohmann::ordered_json& ours,
                    const std::string& scenario, const std::string& where) {
  const auto theirs = nlohmann::ordered_json::parse(state.config, nullptr, false);
  for (const auto& [key, value] : ours.items()) {
    // More steps than planned are allowed. No other option may change.
    if (key == "steps") continue;
    const bool known = theirs.is_object() && theirs.contains(key);
    if (known && theirs[key] == value) continue;
    throw UserError(where + ": --" + key + " is " + value.dump() +
                    ", but the checkpoint was made with " +
                    (known ? theirs[key].dump() : "no such option"));
  }
  if (state.scenario != scenario) {
    throw UserError(where + ": the scenario differs from that of the checkpoint");
  }
}

agent::PolicyMetadata MetadataOf(const agent::ObservationConfig& observation,
                                 const dynamics::ControlConfig& control,
                                 const std::string& scenario_hash, const std::string& id,
                                 std::int64_t training_step, std::uint64_t seed) {
  agent::PolicyMetadata m;
  m.id = id;
  m.observation_layout = agent::ObservationLayout(observation);
  m.action_interface = agent::ActionInterfaceName(control.interface);
  m.scenario_hash = scenario_hash;
  m.training_step = training_step;
  m.seed = seed;
  return m;
}

}  // namespace stg::learn

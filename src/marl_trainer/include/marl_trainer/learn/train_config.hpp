#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "marl_trainer/learn/algorithm_config.hpp"
#include "marl_trainer/learn/options.hpp"
#include "stg_env/env/seed_blocks.hpp"
#include "stg_env/env/variants.hpp"

namespace stg::learn {

/// Options that every training has, for any algorithm. Defaults are the `fast` preset.
struct TrainConfig {
  std::string preset = "fast";
  env::Variant variant = env::Variant::kStg;
  std::uint64_t seed = 0;
  std::int64_t steps = 500000;

  int envs = 64;
  int horizon = 50;
  bool stagger = true;
  std::string start_from;  ///< folder of another run; empty: the networks start untrained

  std::int64_t validation_interval = 32000;
  int validation_episodes = 32;
  std::int64_t checkpoint_interval = 128000;
  int keep_checkpoints = 3;

  void Describe(config::Table* table);
};

/// The whole setup of a training run, except the scenario and the output folder. It can be copied.
struct TrainSetup {
  /// The preset of an algorithm. Throws UserError that lists the known names if one of the two
  /// names is unknown.
  TrainSetup(const std::string& algorithm, const std::string& preset);
  TrainSetup(const TrainSetup& other);
  TrainSetup& operator=(const TrainSetup& other);
  TrainSetup(TrainSetup&&) = default;
  TrainSetup& operator=(TrainSetup&&) = default;

  std::string algorithm;  ///< name in the registry
  TrainConfig common;
  std::unique_ptr<AlgorithmConfig> own;  ///< options of the algorithm; never null

  /// Every option of the command line except preset, variant and algorithm. The table refers to
  /// this object.
  config::Table Options();

  /// Throws UserError that names the option.
  void ValidateOrThrow() const;
};

nlohmann::ordered_json ToJson(const TrainSetup& setup);
/// Inverse of ToJson. Throws UserError for a missing or unknown field.
TrainSetup TrainSetupFromJson(const nlohmann::ordered_json& json);

/// Seed of the first validation episode. Episode r has this seed + r. Validation chooses
/// policy_best.
inline constexpr std::uint64_t kValidationSeed = 900'000;
static_assert(kValidationSeed >= env::kChoosingSeeds.first &&
              kValidationSeed <= env::kChoosingSeeds.last);
/// First seed of the episodes in a training with this seed.
inline std::uint64_t TrainingSeed(std::uint64_t seed) {
  return (seed + 1) * env::kTrainingSeeds.first;
}

}  // namespace stg::learn

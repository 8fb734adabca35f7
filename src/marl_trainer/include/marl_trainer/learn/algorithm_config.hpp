#pragma once

#include <memory>
#include <string>

#include "auv_common/registry.hpp"
#include "marl_trainer/learn/algorithm.hpp"
#include "marl_trainer/learn/comm/team.hpp"
#include "marl_trainer/learn/options.hpp"

namespace stg::learn {

struct ImitationConfig;
struct TrainConfig;

/// Configuration of one algorithm, default-initialised to the `fast` preset, and the way to make
/// it.
class AlgorithmConfig {
 public:
  virtual ~AlgorithmConfig() = default;
  virtual std::unique_ptr<AlgorithmConfig> Clone() const = 0;

  /// Adds its options, whose names differ from the common ones (TrainConfig::Describe).
  virtual void Describe(config::Table* table) = 0;
  /// Turns the defaults into those of a preset, of this configuration and of the common one. There
  /// is at least `fast`. Throws UserError that lists the presets for another name.
  virtual void ApplyPreset(const std::string& preset, TrainConfig* common);
  /// Throws UserError, naming the option, for values that contradict each other; ranges have been
  /// checked.
  virtual void ValidateOrThrow(const TrainConfig& common) const;

  /// Turns the defaults into those for updates on few whole recorded episodes, common.horizon
  /// steps each. Throws UserError for an algorithm that cannot learn from recordings.
  virtual void ApplyRecordings(const TrainConfig& common);
  /// Takes the shape of the networks from the policy file to start from. Throws UserError for an
  /// algorithm that cannot.
  virtual void FitPolicy(const agent::Policy& policy);

  /// The stage of imitation at the start of a training; null: the algorithm has none.
  virtual const ImitationConfig* Imitation() const { return nullptr; }
  /// Among how many ranks it can learn, at most.
  virtual int MostRanks() const { return 1; }
  /// @param common, problem are copied. @param team who computes the update; outlives the
  /// algorithm.
  virtual std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                          const Team& team) const = 0;
};

/// What a configuration `Config` derives from, that extends `Base`, to be able to copy itself.
template <class Config, class Base = AlgorithmConfig>
class CopyableConfig : public Base {
 public:
  std::unique_ptr<AlgorithmConfig> Clone() const override {
    return std::make_unique<Config>(static_cast<const Config&>(*this));
  }
};

/// Algorithms by the name that --algorithm takes.
using AlgorithmRegistry = Registry<AlgorithmConfig>;
AlgorithmRegistry& Algorithms();
/// The one that is meant where none is named.
std::string DefaultAlgorithm();

}  // namespace stg::learn

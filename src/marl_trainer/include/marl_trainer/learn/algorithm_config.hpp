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

/// Configuration of one algorithm, and the factory of the algorithm. Its defaults are the `fast`
/// preset.
class AlgorithmConfig {
 public:
  virtual ~AlgorithmConfig() = default;
  virtual std::unique_ptr<AlgorithmConfig> Clone() const = 0;

  /// Adds the algorithm's options. Their names differ from the common ones (TrainConfig::Describe).
  virtual void Describe(config::Table* table) = 0;
  /// Replaces the defaults of this configuration and of the common one by those of a preset. Every
  /// algorithm has at least `fast`. Throws UserError that lists the presets for any other name.
  virtual void ApplyPreset(const std::string& preset, TrainConfig* common);
  /// Throws UserError that names the option, for values that contradict each other. The ranges have
  /// been checked before.
  virtual void ValidateOrThrow(const TrainConfig& common) const;

  /// Replaces the defaults by those for updates on a few whole recorded episodes of common.horizon
  /// steps each. Throws UserError if the algorithm cannot learn from recordings.
  virtual void ApplyRecordings(const TrainConfig& common);
  /// Takes the shape of the networks from the policy file that the training starts from. Throws
  /// UserError if the algorithm cannot do this.
  virtual void FitPolicy(const agent::Policy& policy);

  /// Imitation at the start of a training; null: the algorithm has none.
  virtual const ImitationConfig* Imitation() const { return nullptr; }
  /// True if the algorithm has a critic that reads the state of the whole swarm.
  virtual bool ReadsState() const { return true; }
  /// Largest number of ranks that the algorithm can learn with.
  virtual int MostRanks() const { return 1; }
  /// @param common, problem are copied. @param team computes the update; it must outlive the
  /// algorithm.
  virtual std::unique_ptr<Algorithm> Make(const TrainConfig& common, const Problem& problem,
                                          const Team& team) const = 0;
};

/// Base class of a configuration `Config` that extends `Base`; it adds Clone().
template <class Config, class Base = AlgorithmConfig>
class CopyableConfig : public Base {
 public:
  std::unique_ptr<AlgorithmConfig> Clone() const override {
    return std::make_unique<Config>(static_cast<const Config&>(*this));
  }
};

/// Algorithms, by the name that --algorithm takes.
using AlgorithmRegistry = Registry<AlgorithmConfig>;
AlgorithmRegistry& Algorithms();
/// The algorithm that is used if none is named.
std::string DefaultAlgorithm();

}  // namespace stg::learn

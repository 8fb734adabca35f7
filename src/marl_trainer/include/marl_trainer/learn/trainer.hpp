#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "marl_trainer/learn/algorithms/mappo/learner.hpp"
#include "marl_trainer/learn/train_log.hpp"
#include "marl_trainer/learn/validation.hpp"

namespace stg::learn {

/// MAPPO (Eqs. 37-44): collect, update, validate, save; one instance per run.
///
/// Weights depend on scenario, configuration and seed only, not on the number
/// of workers. A run and one that was stopped and resumed are the same bit for
/// bit: checkpoints are taken at boundaries where every environment starts an
/// episode. With `stagger`, or a horizon that does not divide the episode, the
/// running episodes are cut there, in every run, stopped or not.
class Trainer {
 public:
  struct Options {
    std::string out;      ///< folder, created
    bool resume = false;  ///< go on from the newest good checkpoint of `out`
    int workers = 1;
    std::ostream* log = nullptr;
    /// Set non-zero (by a signal) to save at the next boundary and return.
    const std::atomic<int>* stop = nullptr;
    /// Scenarios that the training environments cycle through (kLanes at a time), e.g.
    /// stress conditions; empty: the scenario alone. Validation is on the scenario.
    std::vector<Scenario> mix;
    std::int64_t halt_after = 0;  ///< > 0: as if `stop` were set after so many steps
  };

  /// Throws UserError for a bad configuration, a folder that holds another run
  /// or, with `resume`, none.
  Trainer(const Scenario& scenario, const TrainConfig& config, const Options& options);
  ~Trainer();

  /// True when all steps were made, false when stopped before.
  bool Run();

  const TrainState& state() const { return state_; }
  const ActorCritic& networks() const { return learner_.networks(); }
  agent::Policy MakePolicy() const;

 private:
  void OpenFolder();
  void StartFrom(const std::string& folder);
  void Restore();
  void Iterate(TrainRecord* record);
  void Validate(TrainRecord* record);
  /// Restarts what is not at the start of an episode; true at a boundary, or
  /// anywhere with `force` (the end of a run).
  bool AtBoundary(bool force);
  void Save();
  void SavePolicy(const std::string& name) const;
  double Elapsed() const;

  const Scenario scenario_, train_scenario_, validation_scenario_;
  const std::vector<Scenario> mix_;  // never empty; the scenarios trained in
  const TrainConfig config_;
  const Options options_;
  WorkerPool pool_;
  Learner learner_;
  std::vector<std::unique_ptr<RolloutUnit>> units_;
  Validation validation_;
  std::unique_ptr<TrainLog> log_;
  TrainState state_;
  task::MetricSummary last_validation_;
  double start_ = 0.0;
  std::int64_t next_validation_ = 0, next_checkpoint_ = 0;
};

}  // namespace stg::learn

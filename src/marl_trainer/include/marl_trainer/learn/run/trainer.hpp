#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "marl_trainer/learn/collect/collector.hpp"
#include "marl_trainer/learn/run/run_folder.hpp"
#include "marl_trainer/learn/run/train_log.hpp"
#include "marl_trainer/learn/stopwatch.hpp"

namespace stg::learn {

/// Collect, update, validate, save: one instance per run, of any algorithm.
///
/// Weights depend on scenario, setup and seed only, neither on the number of workers nor on that of
/// ranks, up to kGroups of them. Rank 0 alone writes, into a folder that all ranks can read. A run
/// and one that was stopped and resumed are the same bit for bit: a checkpoint, taken between any
/// two collections, holds what was done since all environments started an episode together. With
/// `stagger`, or a horizon that does not divide the episode, the running episodes are cut for such
/// a start, in every run, stopped or not.
class Trainer {
 public:
  struct Options {
    std::string out;      ///< folder, created
    bool resume = false;  ///< go on from the newest good checkpoint of `out`
    int workers = 1;
    std::ostream* log = nullptr;
    Communicator* ranks = Alone();  ///< to train with
    /// Set non-zero (by a signal) to save after the collection and return.
    const std::atomic<int>* stop = nullptr;
    /// Scenarios that the training environments cycle through, e.g.
    /// stress conditions; empty: the scenario alone. Validation is on the scenario.
    std::vector<Scenario> mix;
    std::int64_t halt_after = 0;  ///< > 0: as if `stop` were set after so many steps
  };

  /// Throws UserError for a bad setup, a folder that holds another run
  /// or, with `resume`, none.
  Trainer(const Scenario& scenario, const TrainSetup& setup, const Options& options);

  /// True when all steps were made, false when stopped before.
  bool Run();

  /// As of now, what a checkpoint would hold; called by all ranks.
  TrainState state() const;
  Algorithm& algorithm() { return *algorithm_; }
  const Problem& problem() const { return problem_; }

 private:
  void Resume();
  void ScheduleNext();
  void Iterate(TrainRecord* record);
  void RunValidation(TrainRecord* record);
  /// Where it is time for all environments to start an episode together, or with `force` (the end
  /// of a run), restarts what is not at the start of one.
  void AlignEpisodes(bool force);
  bool Stopped() const;
  void Save();
  void SavePolicy(const std::string& name) const;
  bool leads() const { return options_.ranks->rank() == 0; }
  double Elapsed() const { return state_.wall_seconds + watch_.seconds(); }

  // As given; as trained in, which validations fly and checkpoints are chosen by; and that with the
  // reward of the first, for the return that compares variants.
  const Scenario scenario_, train_scenario_, evaluation_scenario_;
  const std::vector<Scenario> mix_;  // never empty; the scenarios trained in
  const TrainSetup setup_;
  const Options options_;
  const Problem problem_;
  WorkerPool pool_;
  const Team team_;
  std::unique_ptr<Algorithm> algorithm_;
  Collector collector_;
  RunFolder folder_;
  std::unique_ptr<TrainLog> log_;  // of the rank that leads
  TrainState state_;
  task::MetricSummary last_validation_;
  Stopwatch watch_;
  std::int64_t next_validation_ = 0, next_checkpoint_ = 0;
};

}  // namespace stg::learn

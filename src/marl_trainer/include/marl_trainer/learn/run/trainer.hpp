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

/// Trains any algorithm: collect, update, validate, save. One instance per run.
///
/// Weights depend only on scenario, setup and seed, and neither on the number of workers nor on the
/// number of ranks (up to kGroups). Only rank 0 writes, into a folder that all ranks can read. A
/// run that was stopped and resumed has the same result bit for bit: a checkpoint can be taken
/// between any two collections, and it stores the actions since all environments last started an
/// episode together. With `stagger`, or with a horizon that does not divide the episode, running
/// episodes are cut for such a common start. This happens in every run, even if it is never
/// stopped.
class Trainer {
 public:
  struct Options {
    std::string out;      ///< folder; it is created
    bool resume = false;  ///< continue from the newest good checkpoint of `out`
    int workers = 1;
    std::ostream* log = nullptr;
    Communicator* ranks = Alone();  ///< ranks that train together
    /// A signal sets it non-zero: the trainer then saves after the collection and returns.
    const std::atomic<int>* stop = nullptr;
    /// Scenarios that the training environments cycle through, e.g. stress conditions; empty: only
    /// the scenario. Validation uses the scenario.
    std::vector<Scenario> mix;
    std::int64_t halt_after = 0;  ///< > 0: stop after this number of steps, as if `stop` were set
  };

  /// Throws UserError for a bad setup and for a folder that contains another run; with `resume`,
  /// also for a folder without a run.
  Trainer(const Scenario& scenario, const TrainSetup& setup, const Options& options);

  /// True if all steps were made; false if it was stopped before.
  bool Run();

  /// The state that a checkpoint would store now. All ranks call it.
  TrainState state() const;
  Algorithm& algorithm() { return *algorithm_; }
  const Problem& problem() const { return problem_; }

 private:
  /// Throws UserError if a rank has other options or scenarios than this one.
  void RequireEqualRanks() const;
  void Resume();
  void ScheduleNext();
  void Iterate(TrainRecord* record);
  void RunValidation(TrainRecord* record);
  /// Restarts environments that are not at the start of an episode, if a common start of an episode
  /// is due, or with `force` (at the end of a run).
  void AlignEpisodes(bool force);
  bool Stopped() const;
  void Save();
  void SavePolicy(const std::string& name) const;
  bool leads() const { return options_.ranks->rank() == 0; }
  double Elapsed() const { return state_.wall_seconds + watch_.seconds(); }

  // The given scenario; the one of the training, in which validations fly and by which the best
  // policy is chosen; and this one with the reward of the given scenario, for the return that
  // compares variants.
  const Scenario scenario_, train_scenario_, evaluation_scenario_;
  const std::vector<Scenario> mix_;  // scenarios of the training, never empty
  const TrainSetup setup_;
  const Options options_;
  const Problem problem_;
  WorkerPool pool_;
  const Team team_;
  std::unique_ptr<Algorithm> algorithm_;
  Collector collector_;
  RunFolder folder_;
  std::unique_ptr<TrainLog> log_;  // only in rank 0
  TrainState state_;
  task::MetricSummary last_validation_;
  Stopwatch watch_;
  std::int64_t next_validation_ = 0, next_checkpoint_ = 0;
};

}  // namespace stg::learn

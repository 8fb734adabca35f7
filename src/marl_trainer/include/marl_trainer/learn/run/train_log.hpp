#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "marl_trainer/learn/algorithm.hpp"
#include "stg_env/task/metrics.hpp"

namespace stg::learn {

/// Measurements of one collection and its update.
struct TrainRecord {
  std::int64_t env_steps = 0, collections = 0;
  double wall_seconds = 0.0;  ///< since the start of the run, without interruptions
  // Training episodes that ended in this collection. They have exploration and the training reward.
  int episodes = 0;
  double train_return = 0.0, train_tail_distance = 0.0, train_lost_rate = 0.0;
  double reward = 0.0;            ///< team's reward, mean over steps
  std::vector<double> algorithm;  ///< numbers that the update reported, see Algorithm::Columns
  // Wall-clock seconds of this collection.
  double env_seconds = 0.0, inference_seconds = 0.0, update_seconds = 0.0, validation_seconds = 0.0;
  double update_flops = 0.0;
  bool validated = false;
  /// Metrics of the deterministic policy. `return` uses the reward of the training, which chooses
  /// the best policy. `scenario_return` uses the scenario's reward for the same flights.
  task::MetricSummary validation;
};

/// The labelled numbers of an update as text: "KL 0.0123 clip 0.100".
std::string ReportText(const std::vector<ReportColumn>& columns, const std::vector<double>& values);

/// Writes progress lines, progress.csv, and the times at which the scenario's return reached the
/// thresholds.
class TrainLog {
 public:
  /// @param out folder. @param columns of the algorithm.
  /// @param resume_at >= 0: keep the rows of the CSV up to this step.
  TrainLog(const std::string& out, std::vector<ReportColumn> columns, std::int64_t resume_at,
           std::int64_t total_steps, std::ostream* lines);

  /// Adds a row. Throws UserError if progress.csv cannot be written. Rows may wait for Flush.
  void Add(const TrainRecord& record);
  /// Writes all rows to the file. Throws UserError if this fails.
  void Flush();
  /// Writes summary.json. Throws UserError if this fails.
  /// @param networks of the algorithm.
  /// @param peak_flops measured rate of matrix products on all workers.
  void WriteSummary(const std::vector<NetworkSize>& networks, int workers, double peak_flops,
                    const std::string& stopped, const Communicator& ranks) const;

  /// Prints which validation was the best, where its policy is and how to fly it. Prints nothing
  /// before the first validation.
  void Conclude() const;

  /// State for checkpoints, as JSON text.
  std::string Save() const;
  void Load(const std::string& text);

 private:
  struct Moment {
    double seconds;
    std::int64_t steps;
  };
  void PrintLine(const TrainRecord& record);
  std::string Header() const;

  const std::string out_, csv_path_;
  const std::vector<ReportColumn> columns_;
  const std::int64_t total_steps_;
  std::ostream* lines_;
  std::ofstream csv_;
  std::map<std::string, Moment> reached_;
  std::map<std::string, double> last_validation_, best_validation_;
  double env_seconds_ = 0.0, inference_seconds_ = 0.0, update_seconds_ = 0.0,
         validation_seconds_ = 0.0, update_flops_ = 0.0, wall_seconds_ = 0.0;
  std::int64_t env_steps_ = 0, best_steps_ = -1;
  // At the start of this process, for the estimate of the remaining time, which includes
  // validations.
  double began_wall_ = 0.0;
  std::int64_t began_steps_ = 0;
  // At the last printed line; not part of the state.
  double line_wall_ = -1.0, line_env_ = 0.0, line_inference_ = 0.0, line_update_ = 0.0;
  std::int64_t line_steps_ = 0;
};

}  // namespace stg::learn

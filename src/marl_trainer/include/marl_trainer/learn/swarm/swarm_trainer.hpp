#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/learn/swarm/swarm_learner.hpp"

namespace stg::learn {

/// A training of one policy for swarms of any size: collections, updates, validation, checkpoints.
///
/// The folder gets progress.csv (a row for each collection), validation.csv (a row for each
/// validation and task), policy_last.onnx, policy_best.onnx (the best mean band share in
/// validation), config.json and checkpoint.ckpt. Every `segment` collections all environments start
/// anew and a checkpoint is written, so a resumed training equals an uninterrupted one bit for bit.
class SwarmTrainer {
 public:
  struct Options {
    std::string out;
    bool resume = false;
    std::string start_from;  ///< folder of another training whose networks this one begins with
    int workers = 1;
    std::ostream* log = nullptr;
    const std::atomic<int>* stop = nullptr;
  };

  /// Throws UserError for a folder that holds another training, or none where it is to go on.
  SwarmTrainer(std::vector<SwarmTask> mixture, std::vector<SwarmTask> validation,
               const SwarmConfig& config, const Options& options);

  /// Trains to the end; false: stopped at a checkpoint.
  bool Run();

 private:
  void Segment();
  void Validate();
  void SaveAll();
  void LoadAll();
  std::string ConfigText() const;
  agent::PolicyMetadata Metadata() const;
  std::int64_t StepsOfCollection() const;

  SwarmConfig config_;
  Options options_;
  std::vector<SwarmTask> mixture_, validation_;
  WorkerPool pool_;
  SwarmLearner learner_;
  std::vector<std::unique_ptr<SwarmShard>> shards_;
  std::vector<SwarmRollout> rollouts_;
  std::int64_t steps_ = 0;
  std::uint32_t collection_ = 0, segment_ = 0;
  double seconds_ = 0.0, best_ = -1.0, last_ = -1.0;
  std::string progress_, table_;  // of the CSV files, whole
};

}  // namespace stg::learn

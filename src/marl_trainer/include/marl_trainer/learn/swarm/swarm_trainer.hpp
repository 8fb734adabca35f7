#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "auv_common/folder_lock.hpp"
#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/learn/swarm/swarm_learner.hpp"

namespace stg::learn {

/// Trains one policy for swarms of any size: collections, updates, validation and checkpoints.
///
/// The folder gets progress.csv (one row per collection), validation.csv (one row per validation
/// and task), policy_last.onnx, policy_best.onnx (the best in validation),
/// config.json and checkpoint.ckpt. After every `segment` collections all environments restart and
/// a checkpoint is written. So a resumed training has the same result as an uninterrupted one, bit
/// for bit.
class SwarmTrainer {
 public:
  struct Options {
    std::string out;
    bool resume = false;
    std::vector<std::string> overrides;  ///< of the scenarios, "key=value", for config.json
    std::string start_from;  ///< folder of another training; this one starts with its networks
    int workers = 1;
    std::ostream* log = nullptr;
    const std::atomic<int>* stop = nullptr;
  };

  /// Throws UserError for a folder that contains another training, or none if this one must resume.
  SwarmTrainer(std::vector<SwarmTask> mixture, std::vector<SwarmTask> validation,
               const SwarmConfig& config, const Options& options);

  /// Trains to the end. Returns false if it was stopped at a checkpoint.
  bool Run();

 private:
  void Segment();
  void Validate();
  void SaveAll();
  void LoadAll();
  std::string ConfigText() const;
  agent::PolicyMetadata Metadata() const;
  std::int64_t StepsOfCollection() const;
  /// The metric that chooses the best policy: the share in the band, and between walls the return.
  const char* Score() const;

  SwarmConfig config_;
  Options options_;
  std::optional<FolderLock> lock_;  ///< against other trainings that write into the folder
  std::vector<SwarmTask> mixture_, validation_;
  WorkerPool pool_;
  SwarmLearner learner_;
  std::vector<std::unique_ptr<SwarmShard>> shards_;
  std::vector<SwarmRollout> rollouts_;
  std::int64_t steps_ = 0;
  std::uint32_t collection_ = 0, segment_ = 0;
  double seconds_ = 0.0, best_ = -1.0, last_ = -1.0;
  std::string progress_, table_;  // whole content of the CSV files
};

}  // namespace stg::learn

#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "marl_trainer/learn/algorithms/off_policy/replay_batch.hpp"
#include "marl_trainer/learn/algorithms/off_policy/replay_config.hpp"
#include "marl_trainer/learn/nn/mlp.hpp"
#include "marl_trainer/learn/nn/sliced_gradient.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {

/// Common part of all off-policy methods: the replayed transitions, the normalisers, the schedule
/// of gradient steps, their samples, and checkpoints. A method adds its networks, how they act, and
/// its gradient step. Every rank stores the transitions of all ranks, and computes the gradient of
/// its own slices of a batch.
class ReplayLearner : public Algorithm {
 public:
  /// @param own_rewards samples also have each AUV's own rewards; values then have their scale
  ReplayLearner(const ReplayOptions& options, const TrainConfig& common, const Problem& problem,
                const Team& team, bool own_rewards = false);

  void Begin(const Collection& collection) override;
  void Observe(const Transition& transition) override;
  UpdateReport Update(const UpdateContext& context) override;

  void Save(Archive* archive) const override;
  void Load(const Archive& archive) override;
  void StartFrom(const Archive& archive) override;

  /// Environment steps of which it has received the transitions.
  std::int64_t seen() const { return seen_; }
  const ReplayScales& scales() const { return scales_; }

 protected:
  /// A gradient step: its number in the run, and the factor of the learning rates.
  struct StepContext {
    std::uint32_t number = 0;
    double rate = 1.0;
  };

  /// Adds arrays to checkpoints under this name. The arrays keep their size and outlive this
  /// object.
  /// @param start StartFrom also takes them
  void Keep(const std::string& name, std::vector<float>* numbers, bool start = true);
  void Keep(const std::string& name, AdamState* adam);

  /// One gradient step on the samples in batches(), one for each slice.
  virtual void Step(const StepContext& step) = 0;
  /// The scale of the values changes: the new q is ratio * q + shift. The networks must be changed
  /// so that all predictions stay the same.
  virtual void RescaleValues(double ratio, double shift) = 0;
  /// Numbers of Columns() for the gradient steps since the last call. There were `steps` of them.
  virtual UpdateReport Report(int steps) = 0;

  const Problem& problem() const { return problem_; }
  const ReplayOptions& base() const { return options_; }
  std::uint64_t seed() const { return seed_; }
  WorkerPool* pool() { return team_.pool; }
  std::vector<ReplayBatch>& batches() { return batches_; }
  /// True while actions are still random.
  bool warming_up() const { return seen_ < options_.warmup; }
  /// Place of an environment among all of them, in [0, 1]. Environments explore differently.
  double Rank(int env) const;
  /// Largest number of samples of a slice.
  int slice_rows() const;
  /// Results of all slices of all ranks, from the results of this rank's slices.
  template <class T>
  std::vector<T> OfAllSlices(const std::array<T, kGroups>& own) const {
    const auto from = own.begin() + slices_.first;
    return team_.ranks->Gather(std::vector<T>(from, from + slices_.count));
  }

 private:
  void TakeInMoments();
  void LoadMoments(const Archive& archive);
  void UpdateScales();
  void DrawBatch(std::uint32_t number);

  const ReplayOptions options_;
  const Problem problem_;
  const std::uint64_t seed_;
  const bool own_rewards_;
  const Team team_;
  const GroupShare slices_;      // slices of a batch
  std::size_t first_shard_ = 0;  // index of this rank's first shard among all shards
  ReplayBuffer replay_;
  RunningMoments observations_, states_, rewards_;
  struct Moments {
    RunningMoments observations, states, rewards;
  };
  std::vector<Moments> collected_;  // by shard of this rank
  ReplayScales scales_;
  std::vector<ReplayBatch> batches_;  // by slice
  int envs_ = 1;
  std::int64_t collected_steps_ = 0;
  std::int64_t seen_ = 0;
  std::int64_t gradient_steps_ = 0;
  struct Kept {
    std::string name;
    std::vector<float>* numbers;
    bool start;
  };
  std::vector<Kept> kept_;
  std::vector<std::pair<std::string, AdamState*>> kept_adams_;
  double due_ = 0.0;  // gradient steps that are due
};

/// target += tau (online - target).
void MoveTowards(const std::vector<float>& online, double tau, std::vector<float>* target);

}  // namespace stg::learn

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

/// What all off-policy methods share: the replayed transitions, the normalisers, when a gradient
/// step is due and on which samples, and checkpoints. A method adds its networks: how to act and
/// what a gradient step does. Every rank keeps what all of them have seen, and computes the
/// gradient of its slices of a batch.
class ReplayLearner : public Algorithm {
 public:
  /// @param own_rewards whether samples have each AUV's own rewards, and values their scale
  ReplayLearner(const ReplayOptions& options, const TrainConfig& common, const Problem& problem,
                const Team& team, bool own_rewards = false);

  void Begin(const Collection& collection) override;
  void Observe(const Transition& transition) override;
  UpdateReport Update(const UpdateContext& context) override;

  void Save(Archive* archive) const override;
  void Load(const Archive& archive) override;
  void StartFrom(const Archive& archive) override;

  /// Environment steps that it has seen.
  std::int64_t seen() const { return seen_; }
  const ReplayScales& scales() const { return scales_; }

 protected:
  /// A gradient step: which one of the run, and the share of the learning rates.
  struct StepContext {
    std::uint32_t number = 0;
    double rate = 1.0;
  };

  /// What checkpoints hold of the method, by name; the arrays have their size and outlive this
  /// object.
  /// @param start whether StartFrom takes it too
  void Keep(const std::string& name, std::vector<float>* numbers, bool start = true);
  void Keep(const std::string& name, AdamState* adam);

  /// One gradient step on the samples in batches(), one for each slice.
  virtual void Step(const StepContext& step) = 0;
  /// The values' scale changes: what was q is now ratio * q + shift. No prediction may change.
  virtual void RescaleValues(double ratio, double shift) = 0;
  /// Numbers of Columns() of the gradient steps since the last call, which were `steps`.
  virtual UpdateReport Report(int steps) = 0;

  const Problem& problem() const { return problem_; }
  const ReplayOptions& base() const { return options_; }
  std::uint64_t seed() const { return seed_; }
  WorkerPool* pool() { return team_.pool; }
  std::vector<ReplayBatch>& batches() { return batches_; }
  /// Whether actions are still random.
  bool warming_up() const { return seen_ < options_.warmup; }
  /// Place of an environment among all, in [0, 1]: environments explore differently.
  double Rank(int env) const;
  /// Samples of a slice, at most.
  int slice_rows() const;
  /// What was computed of each slice: of all ranks, from those of this rank's.
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
  const GroupShare slices_;      // of a batch
  std::size_t first_shard_ = 0;  // of this rank among those of all
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
  double due_ = 0.0;  // gradient steps
};

/// target += tau (online - target).
void MoveTowards(const std::vector<float>& online, double tau, std::vector<float>* target);

}  // namespace stg::learn

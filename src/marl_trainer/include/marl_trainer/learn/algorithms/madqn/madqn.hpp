#pragma once

#include <memory>
#include <vector>

#include "marl_trainer/learn/algorithms/madqn/madqn_config.hpp"
#include "marl_trainer/learn/algorithms/off_policy/replay_learner.hpp"
#include "marl_trainer/learn/nn/observed_pass.hpp"

namespace stg::learn {

/// Number of action dimensions that a row of the book sets freely. The other dimensions repeat
/// them.
constexpr int kBookDimensions = 3;

/// The actions that a Q-network chooses from. Each of the `heads` chooses one row of `choices`.
struct Codebook {
  Codebook(const Problem& problem, const QOptions& options);

  /// The row nearest to an action, for head h. @param action [action_size], +-1
  int Nearest(int head, const float* action) const;

  int heads = 1, count = 1, width = 1;  ///< action_size = heads * width
  std::vector<float> choices;           ///< [count, width], in +-1
};

/// MADQN: independent double Q-learning on each AUV's own observation (Tampuu et al. 2017, van
/// Hasselt et al. 2016), with a network that all AUVs share. It learns from the team's reward, or
/// from the AUV's own (QReward). It has one head per action dimension (Tavakoli et al. 2018), or
/// one head for all combinations or for a book of them. The network is dueling (Wang et al. 2016):
/// its outputs are V and then the advantages A [heads, count], and q = V + A - mean A.
class Madqn : public ReplayLearner {
 public:
  Madqn(const ReplayOptions& options, const QOptions& own, const TrainConfig& common,
        const Problem& problem, const Team& team);
  ~Madqn() override;

  void Act(const Decision& decision, const Actions& out) override;
  /// The greedy policy.
  std::vector<agent::Policy> Policies(const agent::PolicyMetadata& metadata) const override;
  std::vector<ReportColumn> Columns() const override;
  std::vector<NetworkSize> Sizes() const override;

  const Mlp& network() const { return network_; }

 protected:
  void Step(const StepContext& step) override;
  void RescaleValues(double ratio, double shift) override;
  UpdateReport Report(int steps) override;

 private:
  struct Scratch;  // per slice

  /// Sums over the samples of a slice, of means over AUVs and heads.
  struct Sums {
    double squares = 0.0, values = 0.0;
  };
  Sums AddGradient(int slice, float* gradient);

  const QOptions own_;
  const Codebook codebook_;
  const Mlp network_;
  std::vector<float> parameters_, target_;
  AdamState adam_;
  SlicedGradient gradient_;
  std::vector<std::unique_ptr<Scratch>> scratch_;
  std::vector<ObservedPass> acting_;      // by worker
  std::vector<std::vector<int>> chosen_;  // by worker: choice of each head of one AUV
  // Sums and last values since the last report.
  double squares_ = 0.0, values_ = 0.0, norm_ = 0.0;
  double rate_ = 1.0;
};

}  // namespace stg::learn

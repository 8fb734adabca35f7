#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/ppo_rows.hpp"
#include "marl_trainer/learn/nn/sliced_gradient.hpp"

namespace stg::learn {

/// Sums over an epoch. Their order depends neither on workers nor on ranks.
class SlicedSums {
 public:
  explicit SlicedSums(const Team& team);

  /// Sums of this rank's group g. The computation of the group's gradient adds to them.
  PpoSums& group(int g) { return groups_[static_cast<std::size_t>(g)]; }
  /// Sums over all minibatches of all ranks. Then the next epoch begins.
  PpoSums EndEpoch();

 private:
  Communicator* ranks_;
  std::vector<PpoSums> groups_;
};

/// Numbers that all on-policy methods report, in the order of the columns.
std::vector<ReportColumn> PpoColumns();

/// Epochs of minibatch gradient steps over one collection, for an actor or the critic. A method
/// chooses the actors, their order and the weights.
class PpoUpdate {
 public:
  /// @param networks must outlive this object.
  PpoUpdate(const ActorCritic& networks, const PpoOptions& options, std::uint64_t seed, int agents,
            const Team& team);
  ~PpoUpdate();

  /// Begins the update on a collection. The number of samples must be a multiple of the minibatch.
  /// @param rollouts must outlive the update. @param collection number of the collection
  void Begin(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales,
             std::uint32_t collection, const UpdateContext& context);

  /// Trains an actor on the rows of these AUVs. It stops early if the actor differs too much from
  /// the one that acted.
  /// @param first_epoch keys the order of the minibatches; the next epochs have the next numbers
  /// @param weights factors of the advantages, by sample; null: 1
  /// @return number of epochs
  int TrainActor(const AuvRange& auvs, std::uint32_t first_epoch,
                 const std::vector<double>* weights, Trained* actor);
  void TrainCritic(int epochs, std::uint32_t first_epoch, Trained* critic);

  /// The numbers of PpoColumns, as means over the actors.
  UpdateReport Report(double explained_variance, const std::vector<const Trained*>& actors) const;

  const PpoSamples& samples() const { return samples_; }

 private:
  struct Scratch;                         // per worker
  static constexpr int kBlockRows = 256;  // rows in a pass through a network

  /// Adds the gradient of the loss for the samples at places from .. to-1.
  using BlockLoss =
      std::function<void(Scratch* scratch, int from, int to, float* gradient, PpoSums* sums)>;
  PpoSums Epoch(std::uint32_t epoch, int block, const BlockLoss& add, SlicedGradient* gradient,
                const std::function<void()>& step);

  const ActorCritic& networks_;
  const PpoOptions options_;
  const std::uint64_t seed_;
  SlicedGradient actor_gradient_, critic_gradient_;
  std::vector<std::unique_ptr<Scratch>> scratch_;
  SlicedSums sums_;
  PpoSamples samples_;
  // State of one update.
  std::uint32_t collection_ = 0;
  double rate_ = 1.0;
  float imitation_ = 0.0F;
  PpoSums last_;                                   // sums of the last epoch of each training
  double actor_norms_ = 0.0, critic_norms_ = 0.0;  // sums over steps, before clipping
  int actor_steps_ = 0, critic_steps_ = 0;
  double products_ = 0.0;  // multiplications per sample
};

}  // namespace stg::learn

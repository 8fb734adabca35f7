#include "marl_trainer/learn/algorithms/on_policy/ppo_update.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {

SlicedSums::SlicedSums(const Team& team)
    : ranks_(team.ranks), groups_(static_cast<std::size_t>(team.share().count)) {}

PpoSums SlicedSums::EndEpoch() {
  PpoSums total;
  for (const PpoSums& part : ranks_->Gather(groups_)) total.Add(part);
  groups_.assign(groups_.size(), PpoSums());
  return total;
}

std::vector<ReportColumn> PpoColumns() {
  return {{"learning_rate", "", 0},        {"kl", "KL", 4},       {"clip_fraction", "clip", 3},
          {"actor_loss", "", 0},           {"value_loss", "", 0}, {"entropy", "H", 2},
          {"explained_variance", "EV", 3}, {"sigma", "sigma", 3}, {"actor_gradient_norm", "", 0},
          {"critic_gradient_norm", "", 0}};
}

/// Memory of one worker for a block.
struct PpoUpdate::Scratch {
  Scratch(const ActorCritic& networks, const PpoOptions& options, int most_rows)
      : loss(networks, options, most_rows), rows(networks, most_rows) {}
  PpoLoss loss;
  PpoRows rows;
};

PpoUpdate::PpoUpdate(const ActorCritic& networks, const PpoOptions& options, std::uint64_t seed,
                     int agents, const Team& team)
    : networks_(networks),
      options_(options),
      seed_(seed),
      actor_gradient_(networks.actor.parameters(), team),
      critic_gradient_(networks.critic.parameters(), team),
      sums_(team),
      samples_(team) {
  for (int w = 0; w < team.pool->workers(); ++w) {
    scratch_.push_back(std::make_unique<Scratch>(networks, options, std::max(kBlockRows, agents)));
  }
}

PpoUpdate::~PpoUpdate() = default;

void PpoUpdate::Begin(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales,
                      std::uint32_t collection, const UpdateContext& context) {
  collection_ = collection;
  rate_ = 1.0 - (1.0 - options_.lr_final) * std::min(context.progress, 1.0);
  imitation_ = static_cast<float>(context.imitation);
  last_ = PpoSums();
  actor_norms_ = critic_norms_ = products_ = 0.0;
  actor_steps_ = critic_steps_ = 0;
  samples_.Prepare(rollouts, scales);
  assert(samples_.size() % options_.minibatch == 0);
}

PpoSums PpoUpdate::Epoch(std::uint32_t epoch, int block, const BlockLoss& add,
                         SlicedGradient* gradient, const std::function<void()>& step) {
  samples_.Shuffle(seed_, collection_, epoch, options_.minibatch);
  for (const std::vector<int>& begins : samples_.minibatches()) {
    gradient->Compute(begins, [&](int group, int worker, int begin, int end, float* into) {
      const int blocks = (end - begin + block - 1) / block;
      for (int k = 0; k < blocks; ++k) {
        add(scratch_[static_cast<std::size_t>(worker)].get(), begin + (end - begin) * k / blocks,
            begin + (end - begin) * (k + 1) / blocks, into, &sums_.group(group));
      }
    });
    step();
  }
  return sums_.EndEpoch();
}

int PpoUpdate::TrainActor(const AuvRange& auvs, std::uint32_t first_epoch,
                          const std::vector<double>* weights, Trained* actor) {
  const BlockLoss add = [&](Scratch* s, int from, int to, float* gradient, PpoSums* sums) {
    s->loss.AddActor(actor->numbers.data(),
                     s->rows.Actor(samples_, from, to, auvs, weights, imitation_),
                     options_.minibatch, gradient, sums);
  };
  const auto step = [&] {
    std::vector<float>& p = actor->numbers;
    actor_norms_ += actor_gradient_.Apply(Adam(options_.adam_eps, &actor->adam), 0, p.size(),
                                          options_.lr * rate_, options_.grad_clip, p.data());
    for (std::size_t a = networks_.actor.log_std_offset(); a < p.size(); ++a) {
      p[a] = std::min(std::max(p[a], static_cast<float>(options_.min_log_std)),
                      static_cast<float>(options_.max_log_std));
    }
    ++actor_steps_;
  };
  PpoSums sums;
  int epochs = 0;
  for (bool far = false; epochs < options_.epochs && !far; ++epochs) {
    sums = Epoch(first_epoch + static_cast<std::uint32_t>(epochs),
                 std::max(1, kBlockRows / auvs.count), add, &actor_gradient_, step);
    far = options_.target_kl > 0.0 && sums.kl / sums.rows > options_.target_kl;
  }
  last_.Add(sums);
  products_ += epochs * auvs.count * networks_.actor.mean().spec().training_products();
  return epochs;
}

void PpoUpdate::TrainCritic(int epochs, std::uint32_t first_epoch, Trained* critic) {
  const BlockLoss add = [&](Scratch* s, int from, int to, float* gradient, PpoSums* sums) {
    s->loss.AddCritic(critic->numbers.data(), s->rows.Critic(samples_, from, to),
                      options_.minibatch, gradient, sums);
  };
  const auto step = [&] {
    critic_norms_ += critic_gradient_.Apply(Adam(options_.adam_eps, &critic->adam), 0,
                                            critic->numbers.size(), options_.critic_lr * rate_,
                                            options_.grad_clip, critic->numbers.data());
    ++critic_steps_;
  };
  PpoSums sums;
  for (int epoch = 0; epoch < epochs; ++epoch) {
    sums = Epoch(first_epoch + static_cast<std::uint32_t>(epoch), kBlockRows, add,
                 &critic_gradient_, step);
  }
  last_.Add(sums);
  products_ += epochs * networks_.critic.spec().training_products();
}

UpdateReport PpoUpdate::Report(double explained_variance,
                               const std::vector<const Trained*>& actors) const {
  double sigma = 0.0, entropy = 0.0;
  const auto count = static_cast<double>(actors.size());
  for (const Trained* actor : actors) {
    for (std::size_t a = networks_.actor.log_std_offset(); a < actor->numbers.size(); ++a) {
      const auto log_std = static_cast<double>(actor->numbers[a]);
      sigma += std::exp(log_std) / (networks_.action_size() * count);
      entropy += (log_std + agent::kHalfLogTwoPiE) / count;
    }
  }
  UpdateReport report;
  report.values = {options_.lr * rate_,
                   last_.kl / last_.rows,
                   last_.clipped / last_.rows,
                   last_.actor_loss / last_.rows,
                   last_.value_loss / last_.samples,
                   entropy,
                   explained_variance,
                   sigma,
                   actor_norms_ / actor_steps_,
                   critic_norms_ / critic_steps_};
  // Includes the values from which the advantages were estimated.
  report.flops = 2.0 * samples_.size() * (products_ + networks_.critic.spec().forward_products());
  return report;
}

}  // namespace stg::learn

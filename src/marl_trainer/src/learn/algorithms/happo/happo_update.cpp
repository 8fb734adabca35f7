#include "marl_trainer/learn/algorithms/happo/happo_update.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "auv_common/numbers/random.hpp"
#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {
namespace {

/// Epochs of one collection that keys keep apart: those of each AUV, then the critic's.
constexpr std::uint32_t kEpochsOfATurn = 1000;
/// Index of the draw that orders the AUVs, among the draws of a collection's shuffles.
constexpr std::uint32_t kOrderDraw = 1;

}  // namespace

/// One worker's memory for a block.
struct HappoUpdate::Scratch {
  Scratch(const ActorCritic& networks, const PpoOptions& config, double focus)
      : loss(networks, config, focus, kBlock, 1),
        actor(networks.actor.mean(), kBlock),
        rows(networks, kBlock, 1) {}

  PpoLoss loss;
  Mlp::Workspace actor;
  PpoRows rows;
};

HappoUpdate::HappoUpdate(const ActorCritic& networks, const HappoConfig& config,
                         const TrainConfig& common, int agents, WorkerPool* pool)
    : networks_(networks),
      config_(config),
      seed_(common.seed),
      agents_(agents),
      pool_(pool),
      actor_gradient_(networks.actor.parameters(), pool),
      critic_gradient_(networks.critic.parameters(), pool) {
  for (int w = 0; w < pool->workers(); ++w) {
    scratch_.push_back(std::make_unique<Scratch>(networks, config, common.imitation.focus));
  }
}

HappoUpdate::~HappoUpdate() = default;

void HappoUpdate::Join(Communicator* ranks) {
  ranks_ = ranks;
  actor_gradient_.Join(ranks);
  critic_gradient_.Join(ranks);
  samples_.Join(ranks);
  sums_.Join(ranks);
}

void HappoUpdate::DrawOrder(std::uint32_t collection) {
  order_.resize(static_cast<std::size_t>(agents_));
  std::iota(order_.begin(), order_.end(), 0);
  Random random(seed_, Stream::kShuffle, collection, 0, kOrderDraw);
  for (std::size_t i = order_.size() - 1; i > 0; --i) {
    const auto j = static_cast<std::size_t>(random.Uniform() * static_cast<double>(i + 1));
    std::swap(order_[i], order_[j]);
  }
}

PpoBatch HappoUpdate::Gather(int from, int to, int agent, PpoRows* s) {
  const auto inputs = static_cast<std::size_t>(networks_.actor.inputs());
  const auto action = static_cast<std::size_t>(networks_.action_size());
  const auto state = static_cast<std::size_t>(networks_.critic.inputs());
  for (int place = from; place < to; ++place) {
    const std::size_t sample = samples_.at(place);
    const RolloutBuffer& b = samples_.rollout(sample);
    const std::size_t i = samples_.index(sample);
    const auto at = static_cast<std::size_t>(place - from);
    if (agent < 0) {
      std::copy_n(b.states.data() + i * state, state, s->states.data() + at * state);
      s->targets[at] = samples_.target(sample);
      continue;
    }
    const std::size_t row = i * static_cast<std::size_t>(agents_) + static_cast<std::size_t>(agent);
    std::copy_n(b.observations.data() + row * inputs, inputs, s->observations.data() + at * inputs);
    std::copy_n(b.actions.data() + row * action, action, s->actions.data() + at * action);
    if (imitation_ > 0.0F) {
      std::copy_n(b.teacher.data() + row * action, action, s->teacher.data() + at * action);
    }
    s->log_prob[at] = b.log_prob[row];
    const double factor = config_.sequential ? factors_[sample] : 1.0;
    s->advantages[at] =
        static_cast<float>(factor * static_cast<double>(samples_.advantage(sample)));
  }
  return s->Batch(to - from, imitation_);
}

/// @param agent whose rows to gather; less than 0: the critic's
void HappoUpdate::ComputeGradient(int first, int agent, const BlockLoss& add,
                                  SlicedGradient* gradient) {
  gradient->Compute(
      samples_.Slices(first), [&](int slice, int worker, int begin, int end, float* into) {
        Scratch& s = *scratch_[static_cast<std::size_t>(worker)];
        for (int from = begin; from < end; from += kBlock) {
          const PpoBatch batch = Gather(from, std::min(end, from + kBlock), agent, &s.rows);
          add(&s.loss, batch, into, &sums_.slice(slice));
        }
      });
  sums_.EndMinibatch();
}

int HappoUpdate::TrainActor(int agent, std::uint32_t turn, std::vector<float>* actor,
                            AdamState* adam, PpoReport* report) {
  PpoSums sums;
  int steps = 0, epochs = 0;
  for (int epoch = 0; epoch < config_.epochs; ++epoch) {
    samples_.Shuffle(seed_, collection_, turn * kEpochsOfATurn + static_cast<std::uint32_t>(epoch),
                     config_.minibatch);
    for (int first = 0; first < samples_.size(); first += config_.minibatch) {
      ComputeGradient(
          first, agent,
          [&](PpoLoss* loss, const PpoBatch& batch, float* gradient, PpoSums* part) {
            loss->AddActor(actor->data(), batch, config_.minibatch, gradient, part);
          },
          &actor_gradient_);
      const Adam step(config_.adam_eps, adam);
      report->actor_norm +=
          actor_gradient_.Apply(step, 0, actor->size(), config_.lr * learning_rate_scale_,
                                config_.grad_clip, actor->data());
      for (int a = 0; a < networks_.action_size(); ++a) {
        float& log_std = (*actor)[networks_.actor.log_std_offset() + static_cast<std::size_t>(a)];
        log_std = std::min(std::max(log_std, static_cast<float>(config_.min_log_std)),
                           static_cast<float>(config_.max_log_std));
      }
      ++steps;
    }
    sums = sums_.EndEpoch();
    ++epochs;
    if (config_.target_kl > 0.0 && sums.kl / sums.rows > config_.target_kl) break;
  }
  report->sums.Add(sums);
  report->epochs += epochs;
  return steps;
}

void HappoUpdate::TrainCritic(std::vector<float>* critic, AdamState* adam, PpoReport* report) {
  int steps = 0;
  for (int epoch = 0; epoch < config_.epochs; ++epoch) {
    samples_.Shuffle(
        seed_, collection_,
        static_cast<std::uint32_t>(agents_) * kEpochsOfATurn + static_cast<std::uint32_t>(epoch),
        config_.minibatch);
    for (int first = 0; first < samples_.size(); first += config_.minibatch) {
      ComputeGradient(
          first, -1,
          [&](PpoLoss* loss, const PpoBatch& batch, float* gradient, PpoSums* part) {
            loss->AddCritic(critic->data(), batch, config_.minibatch, gradient, part);
          },
          &critic_gradient_);
      const Adam step(config_.adam_eps, adam);
      report->critic_norm +=
          critic_gradient_.Apply(step, 0, critic->size(), config_.critic_lr * learning_rate_scale_,
                                 config_.grad_clip, critic->data());
      ++steps;
    }
    const PpoSums sums = sums_.EndEpoch();
    report->sums.value_loss = sums.value_loss;
    report->sums.samples = sums.samples;
  }
  report->critic_norm /= steps;
}

/// In blocks that no two shards share: the last digits of a product of matrices may depend on how
/// many rows there are, and shards do not depend on the number of ranks.
void HappoUpdate::MultiplyFactors(const std::vector<const RolloutBuffer*>& rollouts, int agent,
                                  const float* actor) {
  struct Block {
    const RolloutBuffer* rollout;
    int from, to;
    double* factors;
  };
  std::vector<Block> blocks;
  double* factors = factors_.data();
  for (const RolloutBuffer* b : rollouts) {
    for (int from = 0; from < b->samples(); from += kBlock) {
      blocks.push_back({b, from, std::min(b->samples(), from + kBlock), factors + from});
    }
    factors += b->samples();
  }
  const auto inputs = static_cast<std::size_t>(networks_.actor.inputs());
  const int size = networks_.action_size();
  const float* log_std = actor + networks_.actor.log_std_offset();
  pool_->Run(static_cast<int>(blocks.size()), [&](int k, int worker) {
    const Block& block = blocks[static_cast<std::size_t>(k)];
    const RolloutBuffer& b = *block.rollout;
    const int rows = block.to - block.from;
    Scratch& s = *scratch_[static_cast<std::size_t>(worker)];
    const auto row = [&](int i) {
      return static_cast<std::size_t>((block.from + i) * agents_ + agent);
    };
    for (int i = 0; i < rows; ++i) {
      std::copy_n(b.observations.data() + row(i) * inputs, inputs,
                  s.rows.observations.data() + static_cast<std::size_t>(i) * inputs);
    }
    networks_.actor.mean().Forward(actor, s.rows.observations.data(), rows, &s.actor);
    for (int i = 0; i < rows; ++i) {
      const float* action = b.actions.data() + row(i) * static_cast<std::size_t>(size);
      const double now =
          agent::GaussianLogDensity(s.actor.output() + i * size, log_std, action, size);
      block.factors[i] *= std::exp(now - static_cast<double>(b.log_prob[row(i)]));
    }
  });
}

/// Summed shard by shard, so that it does not depend on who has which.
double HappoUpdate::RatioMiss(const std::vector<const RolloutBuffer*>& rollouts) const {
  std::vector<double> sums;
  std::size_t sample = 0;
  for (const RolloutBuffer* b : rollouts) {
    double sum = 0.0;
    for (int i = 0; i < b->samples(); ++i) sum += std::abs(factors_[sample++] - 1.0);
    sums.push_back(sum);
  }
  if (ranks_ != nullptr) sums = ranks_->Gather(sums);
  return std::accumulate(sums.begin(), sums.end(), 0.0) / samples_.size();
}

PpoReport HappoUpdate::Run(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales,
                           std::uint32_t collection, double learning_rate_scale, double imitation,
                           HappoParameters* parameters) {
  collection_ = collection;
  learning_rate_scale_ = learning_rate_scale;
  imitation_ = static_cast<float>(imitation);
  samples_.Prepare(rollouts, scales);
  assert(samples_.size() % config_.minibatch == 0);
  factors_.assign(static_cast<std::size_t>(samples_.own()), 1.0);
  DrawOrder(collection);
  PpoReport report;
  report.samples = samples_.size();
  int steps = 0;
  for (std::size_t turn = 0; turn < order_.size(); ++turn) {
    const auto agent = static_cast<std::size_t>(order_[turn]);
    steps += TrainActor(order_[turn], static_cast<std::uint32_t>(turn), &parameters->actors[agent],
                        &parameters->actor_adams[agent], &report);
    MultiplyFactors(rollouts, order_[turn], parameters->actors[agent].data());
  }
  report.actor_norm /= steps;
  ratio_miss_ = RatioMiss(rollouts);
  TrainCritic(&parameters->critic, &parameters->critic_adam, &report);
  const double actor = networks_.actor.mean().spec().training_products();
  report.flops =
      2.0 * samples_.size() *
      (report.epochs * actor + agents_ * networks_.actor.mean().spec().forward_products() +
       config_.epochs * networks_.critic.spec().training_products());
  return report;
}

}  // namespace stg::learn

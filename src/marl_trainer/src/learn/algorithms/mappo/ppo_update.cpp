#include "marl_trainer/learn/algorithms/mappo/ppo_update.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "auv_common/numbers/random.hpp"

namespace stg::learn {

/// Gathered rows of one block, and the networks' scratch memory.
struct PpoUpdate::Scratch {
  Scratch(const ActorCritic& networks, const MappoConfig& config, double focus, int agents)
      : loss(networks, config, focus, kBlock, agents) {
    const auto rows = static_cast<std::size_t>(kBlock * agents);
    observations.resize(rows * static_cast<std::size_t>(networks.actor.inputs()));
    actions.resize(rows * static_cast<std::size_t>(networks.action_size()));
    log_prob.resize(rows);
    teacher.resize(actions.size());
    states.resize(static_cast<std::size_t>(kBlock * networks.critic.inputs()));
    advantages.resize(kBlock);
    targets.resize(kBlock);
  }
  PpoLoss loss;
  std::vector<float> observations, actions, teacher, log_prob, states, advantages, targets;
};

PpoUpdate::PpoUpdate(const ActorCritic& networks, const MappoConfig& config,
                     const TrainConfig& common, int agents, WorkerPool* pool)
    : networks_(networks),
      config_(config),
      seed_(common.seed),
      agents_(agents),
      pool_(pool),
      gradients_(kSlices, std::vector<float>(networks.parameters())),
      gradient_(networks.parameters()) {
  for (int w = 0; w < pool->workers(); ++w) {
    scratch_.push_back(std::make_unique<Scratch>(networks, config, common.imitation.focus, agents));
  }
}

PpoUpdate::~PpoUpdate() = default;

void PpoUpdate::Prepare(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales) {
  rollout_of_.clear();
  index_of_.clear();
  advantages_.clear();
  targets_.clear();
  double sum = 0.0, squares = 0.0;
  for (std::size_t u = 0; u < rollouts.size(); ++u) {
    const RolloutBuffer& b = *rollouts[u];
    for (std::size_t i = 0; i < b.advantages.size(); ++i) {
      const float advantage = b.advantages[i];
      const float target = advantage + b.values[i];
      rollout_of_.push_back(static_cast<int>(u));
      index_of_.push_back(static_cast<int>(i));
      advantages_.push_back(advantage);
      targets_.push_back((target - scales.value_mean) / scales.value_std);
      sum += static_cast<double>(advantage);
      squares += static_cast<double>(advantage) * static_cast<double>(advantage);
    }
  }
  const auto n = static_cast<double>(advantages_.size());
  const double mean = sum / n;
  const double std = std::sqrt(std::max(squares / n - mean * mean, 0.0)) + 1e-8;
  for (float& a : advantages_) a = static_cast<float>((static_cast<double>(a) - mean) / std);
}

void PpoUpdate::Shuffle(std::uint32_t collection, int epoch) {
  order_.resize(advantages_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<int>(i);
  Random random(seed_, Stream::kShuffle, collection, static_cast<std::uint32_t>(epoch), 0);
  for (std::size_t i = order_.size() - 1; i > 0; --i) {
    const auto j = static_cast<std::size_t>(random.Uniform() * static_cast<double>(i + 1));
    std::swap(order_[i], order_[j]);
  }
}

void PpoUpdate::Slice(const std::vector<const RolloutBuffer*>& rollouts, const float* parameters,
                      int first, int slice, int worker) {
  Scratch& s = *scratch_[static_cast<std::size_t>(worker)];
  std::vector<float>& gradient = gradients_[static_cast<std::size_t>(slice)];
  std::fill(gradient.begin(), gradient.end(), 0.0F);
  PpoSums& sums = sums_[static_cast<std::size_t>(slice)];
  sums = PpoSums();
  const int begin = first + config_.minibatch * slice / kSlices;
  const int end = first + config_.minibatch * (slice + 1) / kSlices;
  const auto row = static_cast<std::size_t>(agents_ * networks_.actor.inputs());
  const auto action = static_cast<std::size_t>(agents_ * networks_.action_size());
  const auto state = static_cast<std::size_t>(networks_.critic.inputs());
  const auto agents = static_cast<std::size_t>(agents_);
  const int blocks = (end - begin + kBlock - 1) / kBlock;
  for (int block = 0; block < blocks; ++block) {
    const int from = begin + (end - begin) * block / blocks;
    const int to = begin + (end - begin) * (block + 1) / blocks;
    for (int k = from; k < to; ++k) {
      const auto sample = static_cast<std::size_t>(order_[static_cast<std::size_t>(k)]);
      const RolloutBuffer& b = *rollouts[static_cast<std::size_t>(rollout_of_[sample])];
      const auto i = static_cast<std::size_t>(index_of_[sample]);
      const auto at = static_cast<std::size_t>(k - from);
      std::copy_n(b.observations.data() + i * row, row, s.observations.data() + at * row);
      std::copy_n(b.actions.data() + i * action, action, s.actions.data() + at * action);
      if (imitation_ > 0.0F) {
        std::copy_n(b.teacher.data() + i * action, action, s.teacher.data() + at * action);
      }
      std::copy_n(b.log_prob.data() + i * agents, agents, s.log_prob.data() + at * agents);
      std::copy_n(b.states.data() + i * state, state, s.states.data() + at * state);
      s.advantages[at] = advantages_[sample];
      s.targets[at] = targets_[sample];
    }
    PpoBatch batch;
    batch.count = to - from;
    batch.agents = agents_;
    batch.observations = s.observations.data();
    batch.actions = s.actions.data();
    batch.log_prob = s.log_prob.data();
    batch.states = s.states.data();
    batch.advantages = s.advantages.data();
    batch.targets = s.targets.data();
    batch.teacher = s.teacher.data();
    batch.imitation = imitation_;
    sums.Add(s.loss.AddGradient(parameters, batch, config_.minibatch, gradient.data()));
  }
}

void PpoUpdate::ForRanges(std::size_t count,
                          const std::function<void(std::size_t, std::size_t)>& work) {
  // Waking the workers costs more than a small network's share.
  constexpr std::size_t kSmall = 65536;
  if (count < kSmall) {
    work(0, count);
    return;
  }
  pool_->Run(kSlices, [&](int slice, int) {
    const auto s = static_cast<std::size_t>(slice);
    work(count * s / kSlices, count * (s + 1) / kSlices);
  });
}

void PpoUpdate::Step(double learning_rate_scale, std::vector<float>* parameters, AdamState* adam,
                     PpoReport* report) {
  const std::size_t count = gradient_.size(), split = networks_.critic_offset();
  ForRanges(count, [&](std::size_t begin, std::size_t end) {
    std::copy(gradients_[0].begin() + static_cast<std::ptrdiff_t>(begin),
              gradients_[0].begin() + static_cast<std::ptrdiff_t>(end),
              gradient_.begin() + static_cast<std::ptrdiff_t>(begin));
    for (int slice = 1; slice < kSlices; ++slice) {
      const float* g = gradients_[static_cast<std::size_t>(slice)].data();
      for (std::size_t i = begin; i < end; ++i) gradient_[i] += g[i];
    }
  });
  const double actor_norm = GradientNorm(gradient_.data(), 0, split);
  const double critic_norm = GradientNorm(gradient_.data(), split, count);
  report->actor_norm += actor_norm;
  report->critic_norm += critic_norm;
  assert(std::isfinite(actor_norm) && std::isfinite(critic_norm));

  const Adam step(config_.adam_eps, adam);
  const float actor_shrink = ShrinkTo(config_.grad_clip, actor_norm);
  const float critic_shrink = ShrinkTo(config_.grad_clip, critic_norm);
  ForRanges(count, [&](std::size_t begin, std::size_t end) {
    step.Apply(begin, std::min(end, split), config_.lr * learning_rate_scale, actor_shrink,
               gradient_.data(), parameters->data());
    step.Apply(std::max(begin, split), end, config_.critic_lr * learning_rate_scale, critic_shrink,
               gradient_.data(), parameters->data());
  });
  for (int a = 0; a < networks_.action_size(); ++a) {
    float& log_std = (*parameters)[networks_.actor.log_std_offset() + static_cast<std::size_t>(a)];
    log_std = std::min(std::max(log_std, static_cast<float>(config_.min_log_std)),
                       static_cast<float>(config_.max_log_std));
  }
}

PpoReport PpoUpdate::Run(const std::vector<const RolloutBuffer*>& rollouts, const Scales& scales,
                         std::uint32_t collection, double learning_rate_scale, double imitation,
                         std::vector<float>* parameters, AdamState* adam) {
  imitation_ = static_cast<float>(imitation);
  Prepare(rollouts, scales);
  PpoReport report;
  const int samples = static_cast<int>(advantages_.size());
  assert(samples % config_.minibatch == 0);
  int steps = 0;
  for (int epoch = 0; epoch < config_.epochs; ++epoch) {
    Shuffle(collection, epoch);
    report.sums = PpoSums();
    for (int first = 0; first < samples; first += config_.minibatch) {
      pool_->Run(kSlices, [&](int slice, int worker) {
        Slice(rollouts, parameters->data(), first, slice, worker);
      });
      for (const PpoSums& sums : sums_) report.sums.Add(sums);
      Step(learning_rate_scale, parameters, adam, &report);
      ++steps;
    }
    ++report.epochs;
    if (config_.target_kl > 0.0 && report.sums.kl / report.sums.rows > config_.target_kl) break;
  }
  report.actor_norm /= steps;
  report.critic_norm /= steps;
  report.flops = 2.0 * report.epochs * samples *
                 (agents_ * networks_.actor.mean().spec().training_products() +
                  networks_.critic.spec().training_products());
  return report;
}

}  // namespace stg::learn

#include "marl_trainer/learn/swarm/swarm_learner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/buffers/gae.hpp"
#include "marl_trainer/learn/swarm/swarm_truth.hpp"
#include "marl_trainer/learn/train_config.hpp"
#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {
SwarmLearner::SwarmLearner(const SwarmConfig& config)
    : config_(config),
      size_(agent::CommandSize(config.action)),
      actor_(config.network, size_),
      critic_(SwarmCriticSpec()),
      actor_numbers_(actor_.parameters() + static_cast<std::size_t>(size_)),
      critic_numbers_(critic_.parameters()),
      average_(actor_numbers_.size()),
      actor_adam_(actor_numbers_.size()),
      critic_adam_(critic_numbers_.size()) {
  actor_.Initialise(config.seed, 0, actor_numbers_.data());
  if (config.without != "nothing" || !config.last_command) {
    blind_ = Blinded(config.network, size_, config.without, config.last_command);
  }
  KeepBlind(&actor_numbers_);
  InitialisePool(critic_.blocks(), 1.0, config.seed, 1, critic_numbers_.data());
  std::fill(actor_numbers_.end() - size_, actor_numbers_.end(), static_cast<float>(config.log_std));
  for (int s = 0; s < kSlices; ++s) {
    parts_.push_back({PackedRows(RowSizes(agent::EntityGraphSpec(size_))),
                      PackedRows(RowSizes(critic_.spec())),
                      {},
                      {},
                      {},
                      {},
                      {},
                      {},
                      0.0,
                      0.0,
                      0.0,
                      0.0,
                      0.0});
  }
}

void SwarmLearner::Evaluate(SwarmRollout* r, Part* part) const {
  const auto values_of = [&](const PackedRows& rows) {
    critic_.Forward(critic_numbers_.data(), rows, &part->critic);
    std::vector<float> values(static_cast<std::size_t>(rows.rows()));
    for (std::size_t k = 0; k < values.size(); ++k) {
      values[k] = static_cast<float>(mean_ + std_ * static_cast<double>(part->critic.output()[k]));
    }
    return values;
  };
  r->values = values_of(r->critic);
  Advantages(r, values_of(r->finals), values_of(r->next));
}

void SwarmLearner::Advantages(SwarmRollout* r, const std::vector<float>& finals,
                              const std::vector<float>& next) const {
  const int stride = r->envs * r->agents;
  std::vector<float> final_values(r->values.size(), 0.0F);
  for (std::size_t k = 0; k < final_values.size(); ++k) {
    if (r->final_of[k] >= 0) final_values[k] = finals[static_cast<std::size_t>(r->final_of[k])];
  }
  r->advantages.resize(r->values.size());
  r->returns.resize(r->values.size());
  for (int k = 0; k < stride; ++k) {
    GeneralisedAdvantages(r->rewards.data() + k, r->values.data() + k, r->done.data() + k,
                          final_values.data() + k, next[static_cast<std::size_t>(k)], r->steps,
                          stride, static_cast<float>(config_.gamma),
                          static_cast<float>(config_.lambda), r->advantages.data() + k);
  }
  for (std::size_t k = 0; k < r->values.size(); ++k) {
    r->returns[k] = r->values[k] + r->advantages[k];
  }
}

void SwarmLearner::Normalise(const std::vector<SwarmRollout>& rollouts) {
  double sum = 0.0, square = 0.0, a = 0.0, aa = 0.0, count = 0.0;
  for (const SwarmRollout& r : rollouts) {
    for (std::size_t k = 0; k < r.returns.size(); ++k) {
      if (r.absent[k] != 0) continue;
      const auto g = static_cast<double>(r.returns[k]), x = static_cast<double>(r.advantages[k]);
      sum += g;
      square += g * g;
      a += x;
      aa += x * x;
      count += 1.0;
    }
  }
  advantage_mean_ = static_cast<float>(a / count);
  const double spread = std::sqrt(std::max(aa / count - a / count * a / count, 0.0));
  advantage_scale_ = static_cast<float>(1.0 / (spread + 1e-6));
  seen_ += count;
  const double share = count / std::min(seen_, std::max(config_.value_memory, count));
  const double old_mean = mean_, old_std = std_;
  mean_ += share * (sum / count - mean_);
  square_ += share * (square / count - square_);
  std_ = std::sqrt(std::max(square_ - mean_ * mean_, 1e-4));
  // The predictions of an untrained critic are not worth keeping. Beside a trained actor, they then
  // begin at the mean of the returns.
  if (std::exchange(without_critic_, false)) return;
  // Changes the last layer so that the critic's predictions stay the same.
  const agent::PoolBlocks::Layer& head = critic_.blocks().head;
  float* w = critic_numbers_.data() + head.weight.offset;
  for (std::size_t k = 0; k < head.weight.size(); ++k) {
    w[k] = static_cast<float>(static_cast<double>(w[k]) * old_std / std_);
  }
  float* b = critic_numbers_.data() + head.bias.offset;
  *b = static_cast<float>((static_cast<double>(*b) * old_std + old_mean - mean_) / std_);
}

void SwarmLearner::ActorLoss(const SwarmRollout& r, std::size_t row, int at, double entropy,
                             float share, Part* part) const {
  ActorWorkspace& w = part->actor;
  const float* log_std = actor_numbers_.data() + actor_.parameters();
  float* d_log_std = part->actor_gradient.data() + actor_.parameters();
  const auto clip = static_cast<float>(config_.clip);
  const float* command = r.commands.data() + row * static_cast<std::size_t>(size_);
  const auto first = static_cast<std::size_t>(w.first[static_cast<std::size_t>(at)]);
  const auto chosen = static_cast<std::size_t>(r.choices[row]);
  const float* mean = w.means.data() + (first + chosen) * static_cast<std::size_t>(size_);
  float z[agent::kCommandNumbers];
  float log_prob = 0.0F;
  for (int c = 0; c < size_; ++c) {
    z[c] = (command[c] - mean[c]) * std::exp(-log_std[c]);
    log_prob -= 0.5F * z[c] * z[c] + log_std[c] + agent::kHalfLogTwoPi;
  }
  if (actor_.chooses()) {
    LogShares(w, at, &part->log_shares);
    log_prob += part->log_shares[chosen];
  }
  const float log_ratio = log_prob - r.log_prob[row], ratio = std::exp(log_ratio);
  const float advantage = (r.advantages[row] - advantage_mean_) * advantage_scale_;
  const bool cut =
      (advantage > 0.0F && ratio > 1.0F + clip) || (advantage < 0.0F && ratio < 1.0F - clip);
  part->kl += static_cast<double>(ratio - 1.0F - log_ratio);
  part->clipped += std::abs(ratio - 1.0F) > clip ? 1.0 : 0.0;
  const auto imitated = static_cast<float>(imitation_);
  const float d_log_prob = cut ? 0.0F : -(1.0F - imitated) * share * advantage * ratio;
  float* d_mean = w.d_means.data() + (first + chosen) * static_cast<std::size_t>(size_);
  for (int c = 0; c < size_; ++c) {
    d_mean[c] = d_log_prob * z[c] * std::exp(-log_std[c]) * (1.0F - mean[c] * mean[c]);
    d_log_std[c] += d_log_prob * (z[c] * z[c] - 1.0F);
  }
  if (imitated > 0.0F) {
    Imitate(r.taught.data() + row * static_cast<std::size_t>(size_), mean, imitated * share, d_mean,
            part);
  }
  if (!actor_.chooses()) return;
  float disorder = 0.0F;
  for (const float l : part->log_shares) disorder -= std::exp(l) * l;
  part->entropy += static_cast<double>(disorder);
  for (std::size_t k = 0; k < part->log_shares.size(); ++k) {
    const float l = part->log_shares[k], p = std::exp(l);
    w.d_logits[first + k] = d_log_prob * ((k == chosen ? 1.0F : 0.0F) - p) +
                            share * static_cast<float>(entropy) * p * (l + disorder);
  }
}

/// Adds the gradient of the squared error of a command, in deviations of the exploration. Errors
/// are weighted by the size of the teacher's command, as in PpoLoss.
void SwarmLearner::Imitate(const float* taught, const float* mean, float share, float* d_mean,
                           Part* part) const {
  const float* log_std = actor_numbers_.data() + actor_.parameters();
  float squares = 0.0F;
  for (int c = 0; c < size_; ++c) {
    const float t = taught[c] * std::exp(-log_std[c]);
    squares += t * t;
  }
  const float weight =
      share * std::pow(1.0F + squares, static_cast<float>(-0.5 * config_.imitation.focus));
  for (int c = 0; c < size_; ++c) {
    const float miss = mean[c] - taught[c];
    d_mean[c] += weight * miss * std::exp(-2.0F * log_std[c]) * (1.0F - mean[c] * mean[c]);
    part->imitation_error += static_cast<double>(miss) * static_cast<double>(miss);
  }
}

/// Parameters for a hidden part of the input stay 0.
void SwarmLearner::KeepBlind(std::vector<float>* numbers) const {
  for (std::size_t k = 0; k < blind_.size(); ++k) {
    if (blind_[k]) (*numbers)[k] = 0.0F;
  }
}

void SwarmLearner::Gradient(const std::vector<SwarmRollout>& rollouts, const std::vector<Row>& rows,
                            std::size_t begin, std::size_t end, std::size_t batch, double entropy,
                            Part* part) const {
  part->actor_rows.Clear();
  part->critic_rows.Clear();
  part->actor_gradient.assign(actor_numbers_.size(), 0.0F);
  part->critic_gradient.assign(critic_numbers_.size(), 0.0F);
  part->kl = part->clipped = part->value_loss = part->entropy = part->imitation_error = 0.0;
  for (std::size_t k = begin; k < end; ++k) {
    const SwarmRollout& r = rollouts[static_cast<std::size_t>(rows[k].rollout)];
    part->actor_rows.Add(r.actor, rows[k].row);
    part->critic_rows.Add(r.critic, rows[k].row);
  }
  actor_.Forward(actor_numbers_.data(), part->actor_rows, &part->actor);
  critic_.Forward(critic_numbers_.data(), part->critic_rows, &part->critic);
  part->d_critic.resize(end - begin);
  const float share = 1.0F / static_cast<float>(batch);
  for (std::size_t k = begin; k < end; ++k) {
    const SwarmRollout& r = rollouts[static_cast<std::size_t>(rows[k].rollout)];
    const auto row = static_cast<std::size_t>(rows[k].row);
    ActorLoss(r, row, static_cast<int>(k - begin), entropy, share, part);
    const auto wanted = static_cast<float>((static_cast<double>(r.returns[row]) - mean_) / std_);
    const float miss = part->critic.output()[k - begin] - wanted;
    part->value_loss += static_cast<double>(miss) * static_cast<double>(miss);
    part->d_critic[k - begin] = share * miss;
  }
  actor_.Backward(actor_numbers_.data(), part->actor_rows, &part->actor,
                  part->actor_gradient.data());
  critic_.Backward(critic_numbers_.data(), part->critic_rows, part->d_critic.data(), &part->critic,
                   part->critic_gradient.data());
}

SwarmLearner::Report SwarmLearner::Update(std::vector<SwarmRollout>* rollouts,
                                          std::uint32_t collection, double progress,
                                          WorkerPool* pool, Learns learns, double imitation) {
  imitation_ = imitation;
  std::vector<Part> scratch;
  for (int w = 0; w < pool->workers(); ++w) scratch.push_back(parts_.front());
  pool->Run(static_cast<int>(rollouts->size()), [&](int k, int worker) {
    Evaluate(&(*rollouts)[static_cast<std::size_t>(k)], &scratch[static_cast<std::size_t>(worker)]);
  });
  Normalise(*rollouts);
  std::vector<Row> rows;
  double reward = 0.0, miss = 0.0, spread = 0.0;
  for (std::size_t r = 0; r < rollouts->size(); ++r) {
    const SwarmRollout& rollout = (*rollouts)[r];
    for (int k = 0; k < rollout.critic.rows(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (rollout.absent[i] != 0) continue;
      rows.push_back({static_cast<int>(r), k});
      const auto a = static_cast<double>(rollout.advantages[i]);
      const double g = static_cast<double>(rollout.returns[i]) - mean_;
      reward += static_cast<double>(rollout.own[i]);
      miss += a * a;
      spread += g * g;
    }
  }
  const std::size_t count = rows.size();
  const std::size_t batches =
      std::max<std::size_t>(1, (count + static_cast<std::size_t>(config_.minibatch) / 2) /
                                   static_cast<std::size_t>(config_.minibatch));
  const double planned =
      config_.learning_rate + (config_.last_learning_rate - config_.learning_rate) * progress;
  const double rate = learns == Learns::kBoth ? planned : SwarmConfig().learning_rate;
  const double critic_rate =
      config_.critic_learning_rate > 0.0 ? config_.critic_learning_rate : rate;
  const double entropy = config_.entropy + (config_.last_entropy - config_.entropy) * progress;
  double kl = 0.0, clipped = 0.0, value_loss = 0.0, norm = 0.0, disorder = 0.0, missed = 0.0;
  int updates = 0, epochs = 0;
  for (int epoch = 0; epoch < config_.epochs; ++epoch) {
    Random random(config_.seed, Stream::kShuffle, collection, static_cast<std::uint32_t>(epoch), 0);
    for (std::size_t k = count - 1; k > 0; --k) {
      const auto j = static_cast<std::size_t>(random.Uniform() * static_cast<double>(k + 1));
      std::swap(rows[k], rows[std::min(j, k)]);
    }
    double epoch_kl = 0.0;
    for (std::size_t b = 0; b < batches; ++b) {
      const std::size_t begin = count * b / batches, batch = count * (b + 1) / batches - begin;
      pool->Run(kSlices, [&](int s, int) {
        const auto i = static_cast<std::size_t>(s);
        Gradient(*rollouts, rows, begin + batch * i / kSlices, begin + batch * (i + 1) / kSlices,
                 batch, entropy, &parts_[i]);
      });
      for (std::size_t s = 1; s < kSlices; ++s) {
        for (std::size_t k = 0; k < actor_numbers_.size(); ++k) {
          parts_[0].actor_gradient[k] += parts_[s].actor_gradient[k];
        }
        for (std::size_t k = 0; k < critic_numbers_.size(); ++k) {
          parts_[0].critic_gradient[k] += parts_[s].critic_gradient[k];
        }
      }
      for (const Part& p : parts_) {
        epoch_kl += p.kl;
        clipped += p.clipped / static_cast<double>(batch);
        value_loss += p.value_loss / static_cast<double>(batch);
        disorder += p.entropy / static_cast<double>(batch);
        missed += p.imitation_error / static_cast<double>(batch);
      }
      KeepBlind(&parts_[0].actor_gradient);
      const auto step = [&](std::vector<float>* gradient, std::vector<float>* numbers, double rate,
                            AdamState* state) {
        const double length = GradientNorm(gradient->data(), 0, gradient->size());
        if (!std::isfinite(length))
          throw UserError("the training diverged: a gradient is not finite");
        Adam(config_.adam_eps, state)
            .Apply(0, numbers->size(), rate, ShrinkTo(config_.gradient_norm, length),
                   gradient->data(), numbers->data());
        return length;
      };
      if (learns == Learns::kBoth) {
        norm += step(&parts_[0].actor_gradient, &actor_numbers_, rate, &actor_adam_);
      }
      step(&parts_[0].critic_gradient, &critic_numbers_, critic_rate, &critic_adam_);
      for (auto s = actor_numbers_.end() - size_; s != actor_numbers_.end(); ++s) {
        *s = std::clamp(*s, static_cast<float>(config_.least_log_std),
                        static_cast<float>(config_.most_log_std));
      }
      ++updates;
    }
    kl = epoch_kl / static_cast<double>(count);
    ++epochs;
    // An imitation moves as far as its rate allows.
    if (imitation < 1.0 && kl > 1.5 * config_.target_kl) break;
  }
  averaged_ = std::min(averaged_ + 1.0, config_.average);
  for (std::size_t k = 0; k < average_.size(); ++k) {
    average_[k] += static_cast<float>((actor_numbers_[k] - average_[k]) / averaged_);
  }
  double sigma = 0.0;
  for (auto s = actor_numbers_.end() - size_; s != actor_numbers_.end(); ++s) {
    sigma += std::exp(static_cast<double>(*s)) / size_;
  }
  return {{"reward", reward / static_cast<double>(count)},
          {"kl", kl},
          {"clipped", clipped / updates},
          {"epochs", epochs},
          {"explained_variance", 1.0 - miss / std::max(spread, 1e-9)},
          {"value_loss", value_loss / updates},
          {"gradient_norm", norm / updates},
          {"sigma", sigma},
          {"choice_entropy", disorder / updates},
          {"imitation_error", missed / updates},
          {"return_mean", mean_},
          {"return_std", std_},
          {"rows", static_cast<double>(count)}};
}

}  // namespace stg::learn

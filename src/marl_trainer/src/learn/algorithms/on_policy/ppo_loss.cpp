#include "marl_trainer/learn/algorithms/on_policy/ppo_loss.hpp"

#include <algorithm>
#include <cmath>

#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {

void PpoSums::Add(const PpoSums& other) {
  actor_loss += other.actor_loss;
  value_loss += other.value_loss;
  kl += other.kl;
  clipped += other.clipped;
  imitation_error += other.imitation_error;
  rows += other.rows;
  samples += other.samples;
}

PpoLoss::PpoLoss(const ActorCritic& networks, const PpoOptions& config, int max_rows)
    : networks_(networks),
      clip_(static_cast<float>(config.clip)),
      focus_(static_cast<float>(-0.5 * config.imitation.focus)),
      entropy_(static_cast<float>(config.entropy)),
      value_weight_(static_cast<float>(config.value_weight)),
      actor_(networks.actor.mean(), max_rows),
      critic_(networks.critic, max_rows),
      d_actor_(static_cast<std::size_t>(max_rows * networks.action_size())),
      d_critic_(static_cast<std::size_t>(max_rows)),
      z_(static_cast<std::size_t>(networks.action_size())),
      inverse_std_(z_.size()),
      d_sigma_(z_.size()) {}

void PpoLoss::AddActor(const float* actor, const PpoBatch& batch, int minibatch, float* gradient,
                       PpoSums* sums) {
  const int rows = batch.count * batch.agents, size = networks_.action_size();
  const float weight = 1.0F / static_cast<float>(minibatch * batch.agents);
  const float* log_std = actor + networks_.actor.log_std_offset();
  float* d_log_std = gradient + networks_.actor.log_std_offset();
  networks_.actor.mean().Forward(actor, batch.observations, rows, &actor_);
  const float* mean = actor_.output();

  float* inverse_std = inverse_std_.data();
  float sum_log_std = 0.0F;
  for (int a = 0; a < size; ++a) {
    inverse_std[a] = std::exp(-log_std[a]);
    sum_log_std += log_std[a] + agent::kHalfLogTwoPi;
  }
  double* d_sigma = d_sigma_.data();
  std::fill_n(d_sigma, size, 0.0);
  float* z = z_.data();
  const float* action = batch.actions;
  const float* teacher = batch.imitation > 0.0F ? batch.teacher : nullptr;
  const float share = 1.0F - batch.imitation;
  float* d = d_actor_.data();
  for (int r = 0; r < rows; ++r, action += size, mean += size, d += size) {
    float log_prob = -sum_log_std;
    for (int a = 0; a < size; ++a) {
      z[a] = (action[a] - mean[a]) * inverse_std[a];
      log_prob -= 0.5F * z[a] * z[a];
    }
    const float advantage = batch.advantages[r / batch.agents];
    const float log_ratio = log_prob - batch.log_prob[r];
    // The limit avoids an overflow of the exponential far outside the trust region.
    const float ratio = std::exp(std::min(log_ratio, 20.0F));
    const float clipped = std::min(std::max(ratio, 1.0F - clip_), 1.0F + clip_);
    sums->actor_loss -= std::min(ratio * advantage, clipped * advantage);
    sums->kl += (ratio - 1.0F) - log_ratio;
    sums->clipped += ratio == clipped ? 0.0 : 1.0;
    // If the clipped branch is smaller, it is constant and has no gradient.
    const bool active = ratio * advantage <= clipped * advantage;
    const float d_log_prob = active ? -weight * share * ratio * advantage : 0.0F;
    // Relative to the size of the teacher's action: station keeping needs finer actions than an
    // approach.
    float shrink = 1.0F;
    if (teacher != nullptr) {
      float squares = 0.0F;
      for (int a = 0; a < size; ++a) {
        const float t = teacher[a] * inverse_std[a];
        squares += t * t;
      }
      shrink = batch.imitation * weight * std::pow(1.0F + squares, focus_);
    }
    for (int a = 0; a < size; ++a) {
      float d_mean = d_log_prob * z[a] * inverse_std[a];
      if (teacher != nullptr) {
        const float miss = mean[a] - teacher[a];
        d_mean += shrink * miss * inverse_std[a] * inverse_std[a];
        sums->imitation_error += static_cast<double>(miss) * miss;
      }
      d[a] = d_mean;
      d_sigma[a] += d_log_prob * (z[a] * z[a] - 1.0F);
    }
    if (teacher != nullptr) teacher += size;
  }
  for (int a = 0; a < size; ++a) {
    // The derivative of the entropy by log sigma is 1 per row.
    d_log_std[a] += static_cast<float>(d_sigma[a]) - entropy_ * weight * static_cast<float>(rows);
  }
  networks_.actor.mean().Backward(actor, batch.observations, d_actor_.data(), rows, &actor_,
                                  gradient);
  sums->rows += rows;
}

void PpoLoss::AddCritic(const float* critic, const PpoBatch& batch, int minibatch, float* gradient,
                        PpoSums* sums) {
  networks_.critic.Forward(critic, batch.states, batch.count, &critic_);
  const float* value = critic_.output();
  const float weight = 2.0F * value_weight_ / static_cast<float>(minibatch);
  for (int r = 0; r < batch.count; ++r) {
    const float error = value[r] - batch.targets[r];
    sums->value_loss += static_cast<double>(error) * error;
    d_critic_[static_cast<std::size_t>(r)] = weight * error;
  }
  networks_.critic.Backward(critic, batch.states, d_critic_.data(), batch.count, &critic_,
                            gradient);
  sums->samples += batch.count;
}

}  // namespace stg::learn

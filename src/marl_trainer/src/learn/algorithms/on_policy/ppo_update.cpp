#include "marl_trainer/learn/algorithms/on_policy/ppo_update.hpp"

#include <algorithm>
#include <cassert>

#include "marl_trainer/learn/algorithms/on_policy/ppo_rows.hpp"

namespace stg::learn {

void SlicedSums::EndMinibatch() {
  for (std::size_t s = 0; s < minibatch_.size(); ++s) {
    (ranks_ != nullptr ? epoch_[s] : total_).Add(minibatch_[s]);
  }
  minibatch_ = Slices();
}

PpoSums SlicedSums::EndEpoch() {
  if (ranks_ != nullptr) {
    const std::vector<PpoSums> own(epoch_.begin(), epoch_.end());
    for (const PpoSums& part : ranks_->Gather(own)) total_.Add(part);
    epoch_ = Slices();
  }
  const PpoSums total = total_;
  total_ = PpoSums();
  return total;
}

std::vector<ReportColumn> PpoColumns() {
  return {{"learning_rate", "", 0},        {"kl", "KL", 4},       {"clip_fraction", "clip", 3},
          {"actor_loss", "", 0},           {"value_loss", "", 0}, {"entropy", "H", 2},
          {"explained_variance", "EV", 3}, {"sigma", "sigma", 3}, {"actor_gradient_norm", "", 0},
          {"critic_gradient_norm", "", 0}};
}

std::vector<double> PpoValues(const PpoReport& report, double learning_rate, double entropy,
                              double explained_variance, double sigma) {
  const PpoSums& sums = report.sums;
  return {learning_rate,
          sums.kl / sums.rows,
          sums.clipped / sums.rows,
          sums.actor_loss / sums.rows,
          sums.value_loss / sums.samples,
          entropy,
          explained_variance,
          sigma,
          report.actor_norm,
          report.critic_norm};
}

/// One worker's memory for a block.
struct PpoUpdate::Scratch {
  Scratch(const ActorCritic& networks, const PpoOptions& config, double focus, int agents)
      : loss(networks, config, focus, kBlock, agents), rows(networks, kBlock, agents) {}
  PpoLoss loss;
  PpoRows rows;
};

PpoUpdate::PpoUpdate(const ActorCritic& networks, const PpoOptions& config,
                     const TrainConfig& common, int agents, WorkerPool* pool)
    : networks_(networks),
      config_(config),
      seed_(common.seed),
      agents_(agents),
      gradient_(networks.parameters(), pool) {
  for (int w = 0; w < pool->workers(); ++w) {
    scratch_.push_back(std::make_unique<Scratch>(networks, config, common.imitation.focus, agents));
  }
}

PpoUpdate::~PpoUpdate() = default;

void PpoUpdate::Join(Communicator* ranks) {
  gradient_.Join(ranks);
  samples_.Join(ranks);
  sums_.Join(ranks);
}

PpoSums PpoUpdate::Slice(const float* parameters, int begin, int end, int worker, float* gradient) {
  Scratch& s = *scratch_[static_cast<std::size_t>(worker)];
  PpoRows& rows = s.rows;
  PpoSums sums;
  const auto row = static_cast<std::size_t>(agents_ * networks_.actor.inputs());
  const auto action = static_cast<std::size_t>(agents_ * networks_.action_size());
  const auto state = static_cast<std::size_t>(networks_.critic.inputs());
  const auto agents = static_cast<std::size_t>(agents_);
  const int blocks = (end - begin + kBlock - 1) / kBlock;
  for (int block = 0; block < blocks; ++block) {
    const int from = begin + (end - begin) * block / blocks;
    const int to = begin + (end - begin) * (block + 1) / blocks;
    for (int k = from; k < to; ++k) {
      const std::size_t sample = samples_.at(k);
      const RolloutBuffer& b = samples_.rollout(sample);
      const std::size_t i = samples_.index(sample);
      const auto at = static_cast<std::size_t>(k - from);
      std::copy_n(b.observations.data() + i * row, row, rows.observations.data() + at * row);
      std::copy_n(b.actions.data() + i * action, action, rows.actions.data() + at * action);
      if (imitation_ > 0.0F) {
        std::copy_n(b.teacher.data() + i * action, action, rows.teacher.data() + at * action);
      }
      std::copy_n(b.log_prob.data() + i * agents, agents, rows.log_prob.data() + at * agents);
      std::copy_n(b.states.data() + i * state, state, rows.states.data() + at * state);
      rows.advantages[at] = samples_.advantage(sample);
      rows.targets[at] = samples_.target(sample);
    }
    sums.Add(s.loss.AddGradient(parameters, s.rows.Batch(to - from, imitation_), config_.minibatch,
                                gradient));
  }
  return sums;
}

void PpoUpdate::Step(double learning_rate_scale, std::vector<float>* parameters, AdamState* adam,
                     PpoReport* report) {
  const std::size_t split = networks_.critic_offset();
  const Adam step(config_.adam_eps, adam);
  report->actor_norm += gradient_.Apply(step, 0, split, config_.lr * learning_rate_scale,
                                        config_.grad_clip, parameters->data());
  report->critic_norm +=
      gradient_.Apply(step, split, networks_.parameters(), config_.critic_lr * learning_rate_scale,
                      config_.grad_clip, parameters->data());
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
  samples_.Prepare(rollouts, scales);
  PpoReport report;
  const int samples = report.samples = samples_.size();
  assert(samples % config_.minibatch == 0);
  int steps = 0;
  for (int epoch = 0; epoch < config_.epochs; ++epoch) {
    samples_.Shuffle(seed_, collection, static_cast<std::uint32_t>(epoch), config_.minibatch);
    for (int first = 0; first < samples; first += config_.minibatch) {
      gradient_.Compute(
          samples_.Slices(first), [&](int slice, int worker, int begin, int end, float* gradient) {
            sums_.slice(slice) = Slice(parameters->data(), begin, end, worker, gradient);
          });
      sums_.EndMinibatch();
      Step(learning_rate_scale, parameters, adam, &report);
      ++steps;
    }
    report.sums = sums_.EndEpoch();
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

#include "marl_trainer/learn/algorithms/on_policy/valued_rollouts.hpp"

#include <algorithm>

#include "marl_trainer/learn/buffers/gae.hpp"
#include "marl_trainer/learn/nn/moments_of_ranks.hpp"

namespace stg::learn {
namespace {

constexpr int kValueRows = 256;

}  // namespace

ValuedRollouts::ValuedRollouts(const Problem& problem, const PpoOptions& config, const Mlp& critic,
                               const Team& team)
    : problem_(problem),
      gamma_(static_cast<float>(config.gamma)),
      lambda_(static_cast<float>(config.lambda)),
      moment_stride_(config.moment_stride),
      critic_(critic),
      team_(team),
      normalisers_(problem, config),
      workspaces_(static_cast<std::size_t>(team.pool->workers()),
                  Mlp::Workspace(critic, kValueRows)) {}

void ValuedRollouts::Begin(const Collection& collection) {
  rollouts_.resize(collection.shards.size());
  for (std::size_t s = 0; s < rollouts_.size(); ++s) {
    Rollout& r = rollouts_[s];
    r.buffer.Begin(problem_, collection.steps, collection.shards[s].envs, collection.taught);
    r.buffer.shard = collection.shards[s];
    r.observations = RunningMoments(problem_.observation_size);
    r.states = RunningMoments(problem_.state_size);
  }
}

void ValuedRollouts::Observe(const Transition& t) {
  Rollout& r = rollouts_[static_cast<std::size_t>(t.shard)];
  if (t.step % moment_stride_ == 0) {
    r.observations.Add(t.observations, t.envs * problem_.agents);
    r.states.Add(t.states, t.envs);
  }
  r.buffer.Add(problem_, t, scales().observations, scales().states);
}

void ValuedRollouts::EstimateValues(const float* critic, const float* states, int rows, int worker,
                                    float* values) {
  Mlp::Workspace& workspace = workspaces_[static_cast<std::size_t>(worker)];
  for (int first = 0; first < rows; first += kValueRows) {
    const int count = std::min(kValueRows, rows - first);
    critic_.Forward(critic, states + static_cast<std::ptrdiff_t>(first) * critic_.inputs(), count,
                    &workspace);
    const float* out = workspace.output();
    for (int r = 0; r < count; ++r) {
      values[first + r] = scales().value_mean + scales().value_std * out[r];
    }
  }
}

void ValuedRollouts::EstimateAdvantages(const float* critic, int shard, int worker) {
  RolloutBuffer& b = rollouts_[static_cast<std::size_t>(shard)].buffer;
  EstimateValues(critic, b.states.data(), b.samples(), worker, b.values.data());
  EstimateValues(critic, b.last_states.data(), b.envs, worker, b.bootstrap.data());
  std::vector<float> finals(b.final_samples.size());
  EstimateValues(critic, b.final_states.data(), static_cast<int>(finals.size()), worker,
                 finals.data());
  for (std::size_t i = 0; i < finals.size(); ++i) {
    b.final_values[static_cast<std::size_t>(b.final_samples[i])] = finals[i];
  }
  for (int e = 0; e < b.envs; ++e) {
    GeneralisedAdvantages(b.rewards.data() + e, b.values.data() + e, b.done.data() + e,
                          b.final_values.data() + e, b.bootstrap[static_cast<std::size_t>(e)],
                          b.steps, b.envs, gamma_, lambda_, b.advantages.data() + e);
  }
}

double ValuedRollouts::Estimate(float* critic) {
  team_.pool->Run(static_cast<int>(rollouts_.size()),
                  [&](int shard, int worker) { EstimateAdvantages(critic, shard, worker); });
  std::vector<float> target;
  std::vector<RunningMoments> shards;  // of targets and errors, in turn
  for (const Rollout& r : rollouts_) {
    const RolloutBuffer& b = r.buffer;
    target.resize(b.advantages.size());
    for (std::size_t i = 0; i < target.size(); ++i) target[i] = b.advantages[i] + b.values[i];
    shards.resize(shards.size() + 2, RunningMoments(1));
    shards[shards.size() - 2].Add(target.data(), b.samples());
    shards.back().Add(b.advantages.data(), b.samples());
  }
  RunningMoments targets(1), errors(1);
  const std::vector<RunningMoments> all = OfAllRanks(team_.ranks, shards, 2);
  for (std::size_t k = 0; k < all.size(); ++k) (k % 2 == 0 ? targets : errors).Merge(all[k]);
  normalisers_.AddTargets(targets, critic_, critic);
  return 1.0 - errors.variance(0) / std::max(targets.variance(0), 1e-12);
}

void ValuedRollouts::UpdateInputScales() {
  std::vector<RunningMoments> shards;  // of observations and states, in turn
  for (const Rollout& r : rollouts_) {
    shards.push_back(r.observations);
    shards.push_back(r.states);
  }
  const std::vector<RunningMoments> all = OfAllRanks(team_.ranks, shards, 2);
  for (std::size_t k = 0; k < all.size(); k += 2) normalisers_.Add(all[k], all[k + 1]);
  normalisers_.UpdateInputScales();
}

std::vector<const RolloutBuffer*> ValuedRollouts::buffers() const {
  std::vector<const RolloutBuffer*> buffers;
  for (const Rollout& r : rollouts_) buffers.push_back(&r.buffer);
  return buffers;
}

}  // namespace stg::learn

#include "marl_trainer/learn/algorithms/madqn/madqn.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/nn/gaussian_actor.hpp"

namespace stg::learn {
namespace {

NetworkSpec QSpec(const Problem& problem, const ReplayOptions& options, const Codebook& codebook) {
  NetworkSpec spec;
  spec.inputs = problem.observation_size;
  spec.hidden = options.actor_hidden;
  spec.activation = options.activation;
  spec.outputs = 1 + codebook.heads * codebook.count;
  spec.output_gain = 0.1F;
  return spec;
}

/// Index of the largest value; the first of equal ones, as in agent::Policy.
int Best(const float* advantages, int count) {
  return static_cast<int>(std::max_element(advantages, advantages + count) - advantages);
}

float Mean(const float* x, int count) {
  float sum = 0.0F;
  for (int k = 0; k < count; ++k) sum += x[k];
  return sum / static_cast<float>(count);
}

}  // namespace

Codebook::Codebook(const Problem& problem, const QOptions& options) {
  std::vector<float> bins;
  for (int k = 0; k < options.bins; ++k) {
    const double x = 2.0 * k / (options.bins - 1) - 1.0;
    bins.push_back(static_cast<float>(std::copysign(std::pow(std::abs(x), options.bin_power), x)));
  }
  if (options.heads == QHeads::kSeparate) {
    heads = problem.action_size;
    count = options.bins;
    choices = bins;
    return;
  }
  width = problem.action_size;
  const int free = options.heads == QHeads::kBook ? std::min(width, kBookDimensions) : width;
  for (int d = 0; d < free; ++d) count *= options.bins;
  std::vector<float> code(static_cast<std::size_t>(free));
  for (int k = 0; k < count; ++k) {
    int rest = k;
    for (float& level : code) {
      level = bins[static_cast<std::size_t>(rest % options.bins)];
      rest /= options.bins;
    }
    for (int d = 0; d < width; ++d) choices.push_back(code[static_cast<std::size_t>(d % free)]);
  }
}

int Codebook::Nearest(int head, const float* action) const {
  int best = 0;
  float least = 1e30F;
  for (int k = 0; k < count; ++k) {
    float miss = 0.0F;
    for (int d = 0; d < width; ++d) {
      const float x = choices[static_cast<std::size_t>(k * width + d)] - action[head * width + d];
      miss += x * x;
    }
    if (miss < least) {
      least = miss;
      best = k;
    }
  }
  return best;
}

struct Madqn::Scratch {
  Scratch(const Mlp& q, int rows, int agents)
      : network(q, rows),
        d_outputs(static_cast<std::size_t>(rows * q.outputs())),
        best(static_cast<std::size_t>(rows * (q.outputs() - 1))),
        targets(static_cast<std::size_t>(rows)),
        actions(static_cast<std::size_t>(agents)) {}
  Mlp::Workspace network;
  std::vector<float> d_outputs;
  std::vector<int> best;  // [rows, heads]
  std::vector<float> targets, actions;
};

Madqn::Madqn(const ReplayOptions& options, const QOptions& own, const TrainConfig& common,
             const Problem& problem, const Team& team)
    : ReplayLearner(options, common, problem, team, own.reward == QReward::kOwn),
      own_(own),
      codebook_(problem, own),
      network_(QSpec(problem, options, codebook_)),
      parameters_(network_.parameters()),
      adam_(network_.parameters()),
      gradient_(network_.parameters(), team),
      acting_(PassesOf(network_, team.pool->workers())),
      chosen_(acting_.size(), std::vector<int>(static_cast<std::size_t>(codebook_.heads))) {
  InitialiseOrthogonally(network_.spec(), common.seed, 0, parameters_.data());
  target_ = parameters_;
  Keep("network", &parameters_);
  Keep("target_network", &target_);
  Keep("adam", &adam_);
  for (int s = 0; s < kGroups; ++s) {
    scratch_.push_back(
        std::make_unique<Scratch>(network_, slice_rows() * problem.agents, problem.agents));
  }
}

Madqn::~Madqn() = default;

void Madqn::Act(const Decision& decision, const Actions& out) {
  const int agents = problem().agents, rows = decision.envs * agents;
  const float* outputs = acting_[static_cast<std::size_t>(decision.worker)].Evaluate(
      parameters_.data(), scales().observations, decision.observations, rows);
  const Codebook& book = codebook_;
  std::vector<int>& chosen = chosen_[static_cast<std::size_t>(decision.worker)];
  float* action = out.actions;
  for (int r = 0; r < rows; ++r) {
    const float* advantages = outputs + static_cast<std::ptrdiff_t>(r) * network_.outputs() + 1;
    for (int h = 0; h < book.heads; ++h) {
      chosen[static_cast<std::size_t>(h)] = Best(advantages + h * book.count, book.count);
    }
    if (decision.explore != nullptr) {
      const DrawKeys& keys = *decision.explore;
      Random random(keys.seed, Stream::kPolicy, keys.collection, keys.step,
                    static_cast<std::uint32_t>(keys.first_env * agents + r));
      const double epsilon = own_.epsilon.At(Rank(keys.first_env + r / agents));
      for (int& choice : chosen) {
        if (!warming_up() && random.Uniform() >= epsilon) continue;
        choice = static_cast<int>(random.Uniform() * book.count);
      }
    }
    for (const int choice : chosen) {
      for (int d = 0; d < book.width; ++d) {
        *action++ =
            scales().action * book.choices[static_cast<std::size_t>(choice * book.width + d)];
      }
    }
  }
}

Madqn::Sums Madqn::AddGradient(int slice, float* gradient) {
  const ReplayBatch& batch = batches()[static_cast<std::size_t>(slice)];
  Scratch& s = *scratch_[static_cast<std::size_t>(slice)];
  const Codebook& book = codebook_;
  const int agents = problem().agents, rows = batch.count * agents, outputs = network_.outputs();
  const int heads = book.heads, count = book.count;
  const auto row = [&](int r) {
    return s.network.output() + static_cast<std::ptrdiff_t>(r) * outputs;
  };
  // Double Q-learning: the network chooses, and its target network evaluates the choice.
  network_.Forward(parameters_.data(), batch.next_observations.data(), rows, &s.network);
  for (int r = 0; r < rows; ++r) {
    for (int h = 0; h < heads; ++h) {
      s.best[static_cast<std::size_t>(r * heads + h)] = Best(row(r) + 1 + h * count, count);
    }
  }
  network_.Forward(target_.data(), batch.next_observations.data(), rows, &s.network);
  for (int r = 0; r < rows; ++r) {
    float next = row(r)[0];
    for (int h = 0; h < heads; ++h) {
      const float* advantages = row(r) + 1 + h * count;
      next +=
          (advantages[s.best[static_cast<std::size_t>(r * heads + h)]] - Mean(advantages, count)) /
          static_cast<float>(heads);
    }
    const auto sample = static_cast<std::size_t>(r / agents);
    const float reward = batch.own_rewards.empty() ? batch.rewards[sample]
                                                   : batch.own_rewards[static_cast<std::size_t>(r)];
    s.targets[static_cast<std::size_t>(r)] = reward + batch.discounts[sample] * next;
  }
  // Mean over samples, AUVs and heads of (q - target)^2.
  network_.Forward(parameters_.data(), batch.observations.data(), rows, &s.network);
  const float weight = 2.0F / static_cast<float>(base().batch * agents * heads);
  Sums sums;
  for (int r = 0; r < rows; ++r) {
    const float* action =
        batch.actions.data() + static_cast<std::ptrdiff_t>(r) * problem().action_size;
    float* d = s.d_outputs.data() + static_cast<std::ptrdiff_t>(r) * outputs;
    d[0] = 0.0F;
    for (int h = 0; h < heads; ++h) {
      const float* advantages = row(r) + 1 + h * count;
      const int chosen = book.Nearest(h, action);
      const float value = row(r)[0] + advantages[chosen] - Mean(advantages, count);
      const float error = value - s.targets[static_cast<std::size_t>(r)];
      const float d_q = weight * error;
      sums.squares += static_cast<double>(error) * static_cast<double>(error) / (agents * heads);
      sums.values += static_cast<double>(value) / (agents * heads);
      d[0] += d_q;
      float* d_advantages = d + 1 + h * count;
      std::fill_n(d_advantages, count, -d_q / static_cast<float>(count));
      d_advantages[chosen] += d_q;
    }
  }
  network_.Backward(parameters_.data(), batch.observations.data(), s.d_outputs.data(), rows,
                    &s.network, gradient);
  return sums;
}

void Madqn::Step(const StepContext& step) {
  rate_ = step.rate;
  std::array<Sums, kGroups> parts{};
  gradient_.ComputeEqual(base().batch, [&](int slice, int, int, int, float* gradient) {
    parts[static_cast<std::size_t>(slice)] = AddGradient(slice, gradient);
  });
  const Adam adam(base().adam_eps, &adam_);
  norm_ += gradient_.Apply(adam, 0, network_.parameters(), base().lr * step.rate, base().grad_clip,
                           parameters_.data());
  for (const Sums& part : OfAllSlices(parts)) {
    squares_ += part.squares / base().batch;
    values_ += part.values / base().batch;
  }
  MoveTowards(parameters_, base().tau, &target_);
}

void Madqn::RescaleValues(double ratio, double shift) {
  RescaleOutputs(network_, ratio, shift, parameters_.data());
  RescaleOutputs(network_, ratio, shift, target_.data());
}

UpdateReport Madqn::Report(int steps) {
  const double n = std::max(steps, 1);
  UpdateReport report;
  report.values = {base().lr * rate_, squares_ / n,
                   static_cast<double>(scales().reward_std) * (values_ / n) +
                       static_cast<double>(scales().value_mean),
                   norm_ / n};
  report.flops = 2.0 * base().batch * steps * problem().agents *
                 (2.0 * network_.spec().forward_products() + network_.spec().training_products());
  squares_ = values_ = norm_ = 0.0;
  return report;
}

std::vector<ReportColumn> Madqn::Columns() const {
  return {{"learning_rate", "", 0},
          {"critic_loss", "TD", 5},
          {"value", "Q", 2},
          {"gradient_norm", "|d|", 4}};
}

std::vector<NetworkSize> Madqn::Sizes() const { return {{"values", network_.parameters()}}; }

std::vector<agent::Policy> Madqn::Policies(const agent::PolicyMetadata& metadata) const {
  // The largest advantage does not depend on V, so the first row of the last layer is left out.
  NetworkSpec spec = network_.spec();
  spec.outputs -= 1;
  spec.squash = scales().action;
  const int last = network_.layers() - 1;
  const auto weight = static_cast<std::ptrdiff_t>(network_.weight_offset(last));
  const auto bias = static_cast<std::ptrdiff_t>(network_.bias_offset(last));
  const auto from = parameters_.begin();
  std::vector<float> parameters(from, from + weight);
  parameters.insert(parameters.end(), from + weight + network_.spec().layer_inputs(last),
                    from + bias);
  parameters.insert(parameters.end(), from + bias + 1, parameters_.end());
  parameters.insert(parameters.end(), static_cast<std::size_t>(spec.outputs), kNoSpread);
  agent::Policy::Parameters p =
      GaussianActor(spec).ToPolicy(parameters.data(), scales().observations, metadata).parameters();
  p.choices.resize(codebook_.count, codebook_.width);
  for (int k = 0; k < codebook_.count; ++k) {
    for (int d = 0; d < codebook_.width; ++d) {
      p.choices(k, d) = codebook_.choices[static_cast<std::size_t>(k * codebook_.width + d)];
    }
  }
  p.log_std.setConstant(problem().action_size, kNoSpread);
  return {agent::Policy(std::move(p))};
}

}  // namespace stg::learn

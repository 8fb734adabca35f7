#include <benchmark/benchmark.h>
#include <torch/nn.h>
#include <torch/optim/adam.h>
#include <torch/utils.h>

#include <cmath>
#include <random>
#include <vector>

#include "marl_trainer/learn/algorithms/on_policy/ppo_loss.hpp"
#include "marl_trainer/learn/nn/adam.hpp"
#include "marl_trainer/learn/nn/blas.hpp"
#include "oracle/torch_network.hpp"

/// Compares the kernels with libtorch on the networks of the presets, on one thread. docs/adr/009
/// has the results.
namespace stg::learn {
namespace {

/// @param width of two hidden layers: 64 with tanh as in the `fast` preset, 128 with ReLU as in
/// `paper`.
NetworkSpec Actor(int width) {
  NetworkSpec spec;
  spec.inputs = 74;
  spec.hidden = {width, width};
  spec.outputs = 3;
  spec.activation = width == 64 ? HiddenActivation::kTanh : HiddenActivation::kRelu;
  spec.squash = 1.0F;
  return spec;
}

std::vector<float> Draw(std::size_t count) {
  std::mt19937 rng(1);
  std::normal_distribution<float> normal;
  std::vector<float> v(count);
  for (float& x : v) x = 0.1F * normal(rng);
  return v;
}

std::size_t Size(int rows, int columns) {
  return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
}

/// Reports rows per second, and the rate of the matrix products.
void Report(benchmark::State& state, int rows, double products) {
  const double done = static_cast<double>(state.iterations()) * rows;
  state.counters["rows"] = benchmark::Counter(done, benchmark::Counter::kIsRate);
  state.counters["FLOPS"] = benchmark::Counter(2.0 * products * done, benchmark::Counter::kIsRate);
}

void KernelsForward(benchmark::State& state) {
  UseOneBlasThread();
  const int rows = static_cast<int>(state.range(1));
  const Mlp mlp(Actor(static_cast<int>(state.range(0))));
  const std::vector<float> p = Draw(mlp.parameters()), x = Draw(Size(rows, mlp.inputs()));
  Mlp::Workspace workspace(mlp, rows);
  for (auto _ : state) {
    mlp.Forward(p.data(), x.data(), rows, &workspace);
    benchmark::DoNotOptimize(workspace.output());
  }
  Report(state, rows, mlp.spec().forward_products());
}

void TorchForward(benchmark::State& state) {
  torch::set_num_threads(1);
  const int rows = static_cast<int>(state.range(1));
  TorchNetwork network(Actor(static_cast<int>(state.range(0))));
  const NetworkSpec spec = Actor(static_cast<int>(state.range(0)));
  SetParameters(Draw(spec.parameters()).data(), network.get());
  std::vector<float> x = Draw(Size(rows, spec.inputs));
  const torch::Tensor input = torch::from_blob(x.data(), {rows, spec.inputs});
  const torch::NoGradGuard no_grad;
  for (auto _ : state) benchmark::DoNotOptimize(network->forward(input).data_ptr<float>());
  Report(state, rows, spec.forward_products());
}

void KernelsTraining(benchmark::State& state) {
  UseOneBlasThread();
  const int rows = static_cast<int>(state.range(1));
  const Mlp mlp(Actor(static_cast<int>(state.range(0))));
  const std::vector<float> p = Draw(mlp.parameters()), x = Draw(Size(rows, mlp.inputs()));
  const std::vector<float> d = Draw(Size(rows, mlp.outputs()));
  std::vector<float> gradient(mlp.parameters());
  Mlp::Workspace workspace(mlp, rows);
  for (auto _ : state) {
    mlp.Forward(p.data(), x.data(), rows, &workspace);
    mlp.Backward(p.data(), x.data(), d.data(), rows, &workspace, gradient.data());
    benchmark::DoNotOptimize(gradient.data());
  }
  Report(state, rows, mlp.spec().training_products());
}

void TorchTraining(benchmark::State& state) {
  torch::set_num_threads(1);
  const int rows = static_cast<int>(state.range(1));
  const NetworkSpec spec = Actor(static_cast<int>(state.range(0)));
  TorchNetwork network(spec);
  SetParameters(Draw(spec.parameters()).data(), network.get());
  std::vector<float> x = Draw(Size(rows, spec.inputs)), d = Draw(Size(rows, spec.outputs));
  const torch::Tensor input = torch::from_blob(x.data(), {rows, spec.inputs});
  const torch::Tensor d_output = torch::from_blob(d.data(), {rows, spec.outputs});
  for (auto _ : state) {
    network->forward(input).backward(d_output);
    benchmark::DoNotOptimize(network->parameters().front().grad().data_ptr<float>());
  }
  Report(state, rows, spec.training_products());
}

/// Random samples of a minibatch of four AUVs, and networks with the sizes of the presets.
struct Minibatch {
  static constexpr int kSamples = 1600, kAgents = 4, kActions = 3, kFeatures = 74, kState = 82;
  static constexpr int kRows = kSamples * kAgents;

  explicit Minibatch(int width) : networks(MakeProblem(), MakeConfig(width)) {
    for (float& x : old) x -= 3.0F;
  }
  static Problem MakeProblem() {
    Problem problem;
    problem.agents = kAgents;
    problem.observation_size = kFeatures;
    problem.state_size = kState;
    problem.action_size = kActions;
    return problem;
  }
  static PpoOptions MakeConfig(int width) {
    PpoOptions config;
    config.actor_hidden = config.critic_hidden = {width, width};
    config.activation = width == 64 ? HiddenActivation::kTanh : HiddenActivation::kRelu;
    return config;
  }
  /// Parameters of the actor, then of the critic.
  std::vector<float> Parameters() const {
    std::vector<float> all = networks.NewActor(1, 0, -1.0).numbers;
    const std::vector<float> critic = networks.NewCritic(1).numbers;
    all.insert(all.end(), critic.begin(), critic.end());
    return all;
  }
  double products() const {
    return kAgents * networks.actor.mean().spec().training_products() +
           networks.critic.spec().training_products();
  }

  const ActorCritic networks;
  std::vector<float> parameters = Parameters();
  std::vector<float> observations = Draw(Size(kRows, kFeatures)),
                     states = Draw(Size(kSamples, kState));
  std::vector<float> actions = Draw(Size(kRows, kActions)), old = Draw(kRows);
  std::vector<float> advantages = Draw(kSamples), targets = Draw(kSamples);
};

/// One gradient step as in PpoUpdate, without gathering: blocks of 64 samples.
void KernelsStep(benchmark::State& state) {
  UseOneBlasThread();
  const int width = static_cast<int>(state.range(0));
  constexpr int kBlock = 64;
  Minibatch m(width);
  const PpoOptions config = Minibatch::MakeConfig(width);
  PpoLoss loss(m.networks, config, kBlock * Minibatch::kAgents);
  PpoSums sums;
  AdamState adam(m.parameters.size());
  std::vector<float> gradient(m.parameters.size());
  const std::size_t split = m.networks.actor.parameters(), count = gradient.size();
  for (auto _ : state) {
    std::fill(gradient.begin(), gradient.end(), 0.0F);
    for (int first = 0; first < Minibatch::kSamples; first += kBlock) {
      PpoBatch batch;
      batch.count = kBlock;
      batch.agents = Minibatch::kAgents;
      const int row = first * Minibatch::kAgents;
      batch.observations = m.observations.data() + Size(row, Minibatch::kFeatures);
      batch.actions = m.actions.data() + Size(row, Minibatch::kActions);
      batch.log_prob = m.old.data() + row;
      batch.states = m.states.data() + Size(first, Minibatch::kState);
      batch.advantages = m.advantages.data() + first;
      batch.targets = m.targets.data() + first;
      loss.AddActor(m.parameters.data(), batch, Minibatch::kSamples, gradient.data(), &sums);
      loss.AddCritic(m.parameters.data() + split, batch, Minibatch::kSamples,
                     gradient.data() + split, &sums);
    }
    const Adam step(1e-5, &adam);
    step.Apply(0, split, 1e-4, ShrinkTo(5.0, GradientNorm(gradient.data(), 0, split)),
               gradient.data(), m.parameters.data());
    step.Apply(split, count, 1e-4, ShrinkTo(5.0, GradientNorm(gradient.data(), split, count)),
               gradient.data(), m.parameters.data());
  }
  Report(state, Minibatch::kSamples, m.products());
}

/// The same step with automatic differentiation and libtorch's Adam, on blocks of `block` samples.
void TorchStep(benchmark::State& state) {
  torch::set_num_threads(1);
  const auto block = state.range(1);
  Minibatch m(static_cast<int>(state.range(0)));
  TorchNetwork actor(m.networks.actor.mean().spec()), critic(m.networks.critic.spec());
  SetParameters(m.parameters.data(), actor.get());
  SetParameters(m.parameters.data() + m.networks.actor.parameters(), critic.get());
  torch::Tensor log_std = torch::full({Minibatch::kActions}, -1.0F).requires_grad_(true);
  std::vector<torch::Tensor> actors = actor->parameters(), all;
  actors.push_back(log_std);
  all = actors;
  for (const torch::Tensor& p : critic->parameters()) all.push_back(p);
  torch::optim::Adam adam(all, torch::optim::AdamOptions(1e-4).eps(1e-5));
  const auto view = [](std::vector<float>& v, std::vector<std::int64_t> shape) {
    return torch::from_blob(v.data(), shape);
  };
  const std::int64_t samples = Minibatch::kSamples, agents = Minibatch::kAgents;
  const auto observations = view(m.observations, {samples * agents, Minibatch::kFeatures});
  const auto states = view(m.states, {samples, Minibatch::kState});
  const auto actions = view(m.actions, {samples * agents, Minibatch::kActions});
  const auto old = view(m.old, {samples * agents});
  const auto advantages = view(m.advantages, {samples}), targets = view(m.targets, {samples});
  for (auto _ : state) {
    adam.zero_grad();
    for (std::int64_t first = 0; first < samples; first += block) {
      const auto rows = [&](const torch::Tensor& t) {
        return t.narrow(0, first * agents, block * agents);
      };
      const auto mean = actor->forward(rows(observations));
      const auto z = (rows(actions) - mean) / log_std.exp();
      const auto log_prob = (-0.5 * z * z - log_std - 0.9189385).sum(1);
      const auto ratio = (log_prob - rows(old)).exp();
      const auto a = advantages.narrow(0, first, block).repeat_interleave(agents);
      const auto gain = torch::min(ratio * a, ratio.clamp(0.8, 1.2) * a).sum();
      const auto error = critic->forward(states.narrow(0, first, block)).squeeze(1) -
                         targets.narrow(0, first, block);
      const auto loss = 0.5 * error.pow(2).sum() / samples - gain / (samples * agents);
      loss.backward();
    }
    torch::nn::utils::clip_grad_norm_(actors, 5.0);
    torch::nn::utils::clip_grad_norm_(critic->parameters(), 5.0);
    adam.step();
  }
  Report(state, Minibatch::kSamples, m.products());
}

void Arguments(benchmark::internal::Benchmark* b) {
  b->ArgNames({"width", "rows"});
  // Rows of a shard's decision (16 environments, 4 AUVs), of an update's block, and of a whole
  // minibatch.
  for (const int width : {64, 128}) {
    for (const int rows : {64, 256, 6400}) b->Args({width, rows});
  }
}

BENCHMARK(KernelsForward)->Apply(Arguments);
BENCHMARK(TorchForward)->Apply(Arguments);
BENCHMARK(KernelsTraining)->Apply(Arguments);
BENCHMARK(TorchTraining)->Apply(Arguments);
BENCHMARK(KernelsStep)->ArgName("width")->Arg(64)->Arg(128);
BENCHMARK(TorchStep)->ArgNames({"width", "block"})->ArgsProduct({{64, 128}, {64, 1600}});

}  // namespace
}  // namespace stg::learn

BENCHMARK_MAIN();

#include <benchmark/benchmark.h>
#include <torch/utils.h>

#include <cmath>
#include <random>
#include <vector>

#include "marl_trainer/learn/nn/blas.hpp"
#include "marl_trainer/learn/nn/mlp.hpp"
#include "marl_trainer/learn/nn/torch/torch_network.hpp"

/// The kernels against libtorch on the actor of the presets, one thread: what docs/adr/009 quotes.
namespace stg::learn {
namespace {

/// @param width of two hidden layers; 64 is the `fast` preset, tanh, 128 `paper`, ReLU.
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

/// Rows a second, and the rate of the matrix products.
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

void Arguments(benchmark::internal::Benchmark* b) {
  b->ArgNames({"width", "rows"});
  // A shard's decision (16 environments, 4 AUVs), an update's block, and a whole minibatch.
  for (const int width : {64, 128}) {
    for (const int rows : {64, 256, 6400}) b->Args({width, rows});
  }
}

BENCHMARK(KernelsForward)->Apply(Arguments);
BENCHMARK(TorchForward)->Apply(Arguments);
BENCHMARK(KernelsTraining)->Apply(Arguments);
BENCHMARK(TorchTraining)->Apply(Arguments);

}  // namespace
}  // namespace stg::learn

BENCHMARK_MAIN();

#include <benchmark/benchmark.h>
#include <torch/torch.h>

#include <vector>

#include "learn/draw.hpp"
#include "marl_trainer/learn/nn/blas.hpp"
#include "marl_trainer/learn/swarm/network/pool_batch.hpp"
#include "oracle/torch_blocks.hpp"
#include "stg_agent/entities/entity_policy.hpp"

/// Compares the network `pool` with kernels and with libtorch, on one thread. docs/adr/009 has the
/// results.
namespace stg::learn {
namespace {

constexpr int kObstacles = 2;

/// Rows of AUVs that have received packets of all others in their swarm and know two obstacles.
PackedRows Rows(const agent::PoolSpec& spec, int auvs, int targets, int neighbours) {
  PackedRows packed{RowSizes(spec)};
  const int counts[] = {targets, neighbours, kObstacles};
  for (int r = 0; r < auvs; ++r) {
    const auto key = static_cast<unsigned>(10 * r);
    const std::vector<float> self = Draw(static_cast<std::size_t>(spec.self), 0.5F, key);
    const std::vector<float> search = Draw(static_cast<std::size_t>(spec.search), 0.5F, key + 1);
    std::vector<std::vector<float>> data;
    std::vector<agent::PoolRows> sets;
    for (std::size_t s = 0; s < spec.sets.size(); ++s) {
      data.push_back(Draw(static_cast<std::size_t>(counts[s] * spec.sets[s]), 0.5F,
                          key + 2 + static_cast<unsigned>(s)));
      sets.push_back({nullptr, counts[s], spec.sets[s]});
    }
    for (std::size_t s = 0; s < sets.size(); ++s) sets[s].rows = data[s].data();
    packed.Add(self.data(), search.data(), sets.data());
  }
  return packed;
}

std::vector<float> Parameters(const agent::PoolSpec& spec) {
  return Draw(agent::PoolBlocks(spec).size, 0.1F, 1);
}

/// The same network on the same packed rows: whole matrices, and sums and maxima over segments.
class TorchPool : TorchBlocks<agent::PoolBlocks> {
 public:
  TorchPool(const agent::PoolSpec& spec, const std::vector<float>& p, const PackedRows& x)
      : TorchBlocks(spec, p), auvs_(x.rows()) {
    self_ = TensorOf(x.self(), {auvs_, spec.self});
    search_ = TensorOf(x.search(0), {auvs_, spec.search});
    for (int s = 0; s < spec.sets_count(); ++s) {
      const int count = x.offset(s, auvs_);
      rows_.push_back(TensorOf(x.set(s), {count, spec.sets[static_cast<std::size_t>(s)]}));
      std::vector<std::int64_t> owner;
      for (int r = 0; r < auvs_; ++r) {
        owner.insert(owner.end(), static_cast<std::size_t>(x.offset(s, r + 1) - x.offset(s, r)), r);
      }
      owner_.push_back(torch::tensor(owner).unsqueeze(1).expand({count, spec.width}).contiguous());
    }
  }

  torch::Tensor Forward() const {
    std::vector<torch::Tensor> joined = {torch::relu(Dense(self_, b_.self)), search_};
    for (std::size_t s = 0; s < rows_.size(); ++s) {
      const agent::PoolBlocks::Set& set = b_.sets[s];
      const torch::Tensor h =
          torch::relu(Dense(torch::relu(Dense(rows_[s], set.first)), set.second));
      const torch::Tensor nobody = At(set.nobody).t().expand({auvs_, h.size(1)});
      const torch::Tensor count =
          torch::ones({auvs_, h.size(1)}).scatter_add(0, owner_[s], torch::ones_like(h));
      joined.push_back(nobody.scatter_add(0, owner_[s], h) / count);
      joined.push_back(nobody.contiguous().scatter_reduce(0, owner_[s], h, "amax"));
    }
    const torch::Tensor y =
        torch::relu(Dense(torch::relu(Dense(torch::cat(joined, 1), b_.trunk1)), b_.trunk2));
    return Dense(y, b_.head);
  }

  void Backward(const torch::Tensor& loss) {
    for (torch::Tensor& w : weights_) w.mutable_grad() = torch::Tensor();
    loss.backward();
  }

 private:
  int auvs_;
  torch::Tensor self_, search_;
  std::vector<torch::Tensor> rows_, owner_;
};

void Report(benchmark::State& state, int auvs) {
  state.counters["AUVs"] = benchmark::Counter(static_cast<double>(state.iterations()) * auvs,
                                              benchmark::Counter::kIsRate);
}

/// @param state [AUVs, targets, neighbours]
void KernelsStep(benchmark::State& state) {
  UseOneBlasThread();
  const agent::PoolSpec spec = agent::EntityActorSpec(5);
  const PoolBatch pool(spec);
  const int auvs = static_cast<int>(state.range(0));
  const PackedRows x =
      Rows(spec, auvs, static_cast<int>(state.range(1)), static_cast<int>(state.range(2)));
  const std::vector<float> p = Parameters(spec);
  const std::vector<float> d = Draw(static_cast<std::size_t>(auvs * spec.outputs), 1.0F, 2);
  PoolBatch::Workspace w;
  std::vector<float> gradient(pool.parameters());
  for (auto _ : state) {
    std::fill(gradient.begin(), gradient.end(), 0.0F);
    pool.Forward(p.data(), x, &w);
    pool.Backward(p.data(), x, d.data(), &w, gradient.data());
    benchmark::DoNotOptimize(gradient.data());
  }
  Report(state, auvs);
}

void TorchStep(benchmark::State& state) {
  torch::set_num_threads(1);
  const agent::PoolSpec spec = agent::EntityActorSpec(5);
  const int auvs = static_cast<int>(state.range(0));
  const PackedRows x =
      Rows(spec, auvs, static_cast<int>(state.range(1)), static_cast<int>(state.range(2)));
  TorchPool pool(spec, Parameters(spec), x);
  const PoolBatch kernels(spec);
  PoolBatch::Workspace w;
  kernels.Forward(Parameters(spec).data(), x, &w);
  const torch::Tensor ours = TensorOf(w.output(), {auvs, spec.outputs});
  if ((pool.Forward() - ours).abs().max().item<float>() > 1e-4F) {
    state.SkipWithError("this is another network than that of the kernels");
  }
  const torch::Tensor d = torch::ones({auvs, spec.outputs});
  for (auto _ : state) pool.Backward((pool.Forward() * d).sum());
  Report(state, auvs);
}

/// The decision of one AUV.
void KernelsDecide(benchmark::State& state) {
  const agent::PoolSpec spec = agent::EntityActorSpec(5);
  const agent::PoolNetwork network(spec, Parameters(spec));
  const PackedRows x =
      Rows(spec, 1, static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  std::vector<agent::PoolRows> sets;
  for (int s = 0; s < spec.sets_count(); ++s) {
    sets.push_back({x.set(s), x.offset(s, 1), spec.sets[static_cast<std::size_t>(s)]});
  }
  float out[agent::PoolNetwork::kMaxOutputs];
  for (auto _ : state) {
    network.Forward(x.self(), x.search(0), sets.data(), out);
    benchmark::DoNotOptimize(out);
  }
}

void TorchDecide(benchmark::State& state) {
  torch::set_num_threads(1);
  const torch::InferenceMode guard;
  const agent::PoolSpec spec = agent::EntityActorSpec(5);
  const PackedRows x =
      Rows(spec, 1, static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const TorchPool pool(spec, Parameters(spec), x);
  for (auto _ : state) benchmark::DoNotOptimize(pool.Forward().data_ptr<float>());
}

BENCHMARK(KernelsStep)->Args({7000, 1, 3})->Args({7000, 2, 7})->Unit(benchmark::kMillisecond);
BENCHMARK(TorchStep)->Args({7000, 1, 3})->Args({7000, 2, 7})->Unit(benchmark::kMillisecond);
BENCHMARK(KernelsDecide)->Args({1, 3})->Args({5, 19})->Unit(benchmark::kMicrosecond);
BENCHMARK(TorchDecide)->Args({1, 3})->Args({5, 19})->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace stg::learn

BENCHMARK_MAIN();

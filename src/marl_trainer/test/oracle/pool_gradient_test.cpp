#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>

#include "learn/draw.hpp"
#include "marl_trainer/learn/swarm/network/pool_batch.hpp"
#include "oracle/torch_blocks.hpp"
#include "stg_agent/entities/entity_policy.hpp"

/// Compares the network over sets with libtorch's automatic differentiation and with the network of
/// the agent.
namespace stg::learn {
namespace {

agent::PoolSpec SmallSpec() {
  agent::PoolSpec spec;
  spec.self = 7;
  spec.search = 3;
  spec.sets = {5, 4};
  spec.outputs = 2;
  spec.width = 6;
  spec.hidden = 9;
  return spec;
}

/// Random rows of AUVs that have 0, 1, ... rows in a set.
PackedRows DrawRows(const agent::PoolSpec& spec, int rows) {
  PackedRows packed{RowSizes(spec)};
  for (int r = 0; r < rows; ++r) {
    const auto key = static_cast<unsigned>(10 * r);
    const std::vector<float> self = Draw(static_cast<std::size_t>(spec.self), 1.0F, key + 1);
    const std::vector<float> search =
        Draw(static_cast<std::size_t>(spec.search + 1), 1.0F, key + 2);
    std::vector<std::vector<float>> data;
    std::vector<agent::PoolRows> sets;
    for (std::size_t s = 0; s < spec.sets.size(); ++s) {
      const int count = (r * (static_cast<int>(s) + 1)) % 4, size = spec.sets[s];
      data.push_back(Draw(static_cast<std::size_t>(count * size + 1), 1.0F,
                          key + 3 + static_cast<unsigned>(s)));
      sets.push_back({nullptr, count, size});
    }
    for (std::size_t s = 0; s < sets.size(); ++s) sets[s].rows = data[s].data();
    packed.Add(self.data(), search.data(), sets.data());
  }
  return packed;
}

/// The network in operations of libtorch.
struct TorchPool : TorchBlocks<agent::PoolBlocks> {
  TorchPool(const agent::PoolSpec& spec, const std::vector<float>& p)
      : TorchBlocks(spec, p), spec_(spec) {}
  torch::Tensor Forward(const PackedRows& x) const {
    std::vector<torch::Tensor> out;
    for (int r = 0; r < x.rows(); ++r) {
      std::vector<torch::Tensor> joined = {
          torch::relu(Dense(TensorOf(x.self() + r * spec_.self, {1, spec_.self}), b_.self)),
          TensorOf(x.search(r), {1, spec_.search})};
      for (int s = 0; s < spec_.sets_count(); ++s) {
        const auto& set = b_.sets[static_cast<std::size_t>(s)];
        const int size = spec_.sets[static_cast<std::size_t>(s)], begin = x.offset(s, r),
                  count = x.offset(s, r + 1) - begin;
        torch::Tensor all = At(set.nobody).t();
        if (count > 0) {
          const torch::Tensor h = torch::relu(
              Dense(torch::relu(Dense(TensorOf(x.set(s) + begin * size, {count, size}), set.first)),
                    set.second));
          all = torch::cat({h, all}, 0);
        }
        joined.push_back(all.mean(0, true));
        joined.push_back(std::get<0>(all.max(0, true)));
      }
      const torch::Tensor y =
          torch::relu(Dense(torch::relu(Dense(torch::cat(joined, 1), b_.trunk1)), b_.trunk2));
      out.push_back(Dense(y, b_.head));
    }
    return torch::cat(out, 0);
  }

  agent::PoolSpec spec_;
};

TEST(PoolBatch, OutputsAndGradientsAreLibtorchs) {
  for (const agent::PoolSpec& spec : {SmallSpec(), agent::EntityActorSpec(5)}) {
    const PoolBatch pool(spec);
    const std::vector<float> p = Draw(pool.parameters(), 0.3F, 1);
    const int rows = 11;
    const PackedRows x = DrawRows(spec, rows);
    const std::vector<float> d = Draw(static_cast<std::size_t>(rows * spec.outputs), 1.0F, 2);
    PoolBatch::Workspace w;
    pool.Forward(p.data(), x, &w);
    std::vector<float> gradient(pool.parameters(), 0.0F);
    pool.Backward(p.data(), x, d.data(), &w, gradient.data());

    const TorchPool reference(spec, p);
    const torch::Tensor y = reference.Forward(x);
    double most = 0.0;
    for (int k = 0; k < rows * spec.outputs; ++k) {
      const double theirs = y.data_ptr<float>()[k];
      most = std::max(most, std::abs(theirs));
      EXPECT_NEAR(w.output()[k], theirs, 1e-4 * std::max(1.0, std::abs(theirs)));
    }
    EXPECT_GT(most, 0.1);
    (y * TensorOf(d.data(), {rows, spec.outputs})).sum().backward();
    const auto blocks = reference.b_.all();
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const torch::Tensor g = reference.weights_[b].grad().contiguous();
      double largest = 0.0, error = 0.0;
      for (std::size_t k = 0; k < blocks[b].size(); ++k) {
        const double theirs = g.data_ptr<float>()[k];
        largest = std::max(largest, std::abs(theirs));
        error =
            std::max(error, std::abs(theirs - static_cast<double>(gradient[blocks[b].offset + k])));
      }
      EXPECT_GT(largest, 0.0) << "block " << b;
      EXPECT_LT(error / largest, 2e-5) << "block " << b;
    }
  }
}

TEST(PoolBatch, ManyAuvsAtOnceGetWhatTheAgentComputesForOne) {
  const agent::PoolSpec spec = agent::EntityActorSpec(5);
  const PoolBatch pool(spec);
  const std::vector<float> p = Draw(pool.parameters(), 0.1F, 4);
  const agent::PoolNetwork one(spec, p);
  const PackedRows x = DrawRows(spec, 13);
  PoolBatch::Workspace w;
  pool.Forward(p.data(), x, &w);
  for (int r = 0; r < x.rows(); ++r) {
    agent::PoolRows sets[agent::kEntitySets];
    for (int s = 0; s < agent::kEntitySets; ++s) {
      const int size = spec.sets[static_cast<std::size_t>(s)];
      sets[s] = {x.set(s) + x.offset(s, r) * size, x.offset(s, r + 1) - x.offset(s, r), size};
    }
    float out[5];
    one.Forward(x.self() + r * spec.self, x.search(r), sets, out);
    for (int k = 0; k < 5; ++k) EXPECT_NEAR(out[k], w.output()[5 * r + k], 1e-5);
  }
}

}  // namespace
}  // namespace stg::learn

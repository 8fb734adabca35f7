#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>

#include "learn/draw.hpp"
#include "marl_trainer/learn/swarm/network/graph_batch.hpp"
#include "oracle/torch_blocks.hpp"
#include "stg_agent/entities/entity_policy.hpp"

/// Compares the network over the task graph with libtorch's automatic differentiation and with the
/// network of the agent.
namespace stg::learn {
namespace {

agent::GraphSpec SmallGraph() {
  agent::GraphSpec spec;
  spec.self = 7;
  spec.search = 3;
  spec.targets = 5;
  spec.neighbours = 4;
  spec.obstacles = 3;
  spec.edges = 2;
  spec.quality = 1;
  spec.follows = 2;
  spec.outputs = 2;
  spec.width = 6;
  spec.hidden = 9;
  spec.heads = 3;
  return spec;
}

/// Random rows of one AUV, with the memory that they point to.
struct DrawnRows {
  DrawnRows(const agent::GraphSpec& spec, int targets, int neighbours, int obstacles,
            unsigned seed) {
    const int counts[] = {targets, neighbours, obstacles};
    const int sizes[] = {spec.targets, spec.neighbours, spec.obstacles};
    self = Draw(static_cast<std::size_t>(spec.self), 1.0F, seed);
    search = Draw(static_cast<std::size_t>(spec.search), 1.0F, seed + 1);
    for (unsigned s = 0; s < 3; ++s) {
      sets[s] = Draw(static_cast<std::size_t>(counts[s] * sizes[s] + 1), 1.0F, seed + 2 + s);
      rows.sets[s] = {sets[s].data(), counts[s], sizes[s]};
    }
    for (int j = 0; j < neighbours; ++j) {  // a quality is never negative
      float& quality = sets[1][static_cast<std::size_t>(j * spec.neighbours + spec.quality)];
      quality = std::abs(quality);
    }
    edges = Draw(static_cast<std::size_t>(targets * neighbours * spec.edges + 1), 1.0F, seed + 5);
    rows.self = self.data();
    rows.search = search.data();
    rows.edges = edges.data();
    rows.edge_target_stride = neighbours * spec.edges;
    rows.edge_stride = spec.edges;
  }
  std::vector<float> self, search, sets[3], edges;
  agent::GraphRows rows;
};

/// AUVs with 0, 1, ... rows in each set.
std::vector<DrawnRows> DrawMany(const agent::GraphSpec& spec, int auvs) {
  std::vector<DrawnRows> many;
  many.reserve(static_cast<std::size_t>(auvs));
  for (int r = 0; r < auvs; ++r) {
    many.emplace_back(spec, r % 3, (r * 2) % 5, (r + 1) % 3, static_cast<unsigned>(10 * r));
  }
  return many;
}

/// The network in operations of libtorch, for one AUV at a time.
struct TorchGraph : TorchBlocks<agent::GraphBlocks> {
  TorchGraph(const agent::GraphSpec& spec, const std::vector<float>& p)
      : TorchBlocks(spec, p), spec_(spec) {}
  torch::Tensor Embed(const agent::PoolRows& rows, const agent::PoolBlocks::Set& set) const {
    const torch::Tensor x = TensorOf(rows.rows, {rows.count, rows.stride});
    return torch::relu(Dense(torch::relu(Dense(x, set.first)), set.second));
  }
  torch::Tensor Attend(int s, const torch::Tensor& self, const torch::Tensor& rows,
                       const torch::Tensor& prior) const {
    const agent::GraphBlocks::Attention& a = b_.attention[static_cast<std::size_t>(s)];
    const int size = spec_.width / spec_.heads;
    const torch::Tensor q = torch::matmul(self, At(a.query).t()),
                        k = torch::matmul(rows, At(a.key).t()),
                        v = torch::matmul(rows, At(a.value).t());
    std::vector<torch::Tensor> heads;
    for (int h = 0; h < spec_.heads; ++h) {
      const auto part = [&](const torch::Tensor& x) { return x.narrow(1, h * size, size); };
      torch::Tensor scores = torch::matmul(part(q), part(k).t()) / std::sqrt(double(size));
      if (prior.defined()) scores = scores + prior * At(b_.prior)[h];
      heads.push_back(torch::matmul(torch::softmax(scores, 1), part(v)));
    }
    return torch::cat(heads, 1);
  }
  /// Choices [targets + 1] and output [targets + 1, outputs].
  std::pair<torch::Tensor, torch::Tensor> Forward(const agent::GraphRows& x) const {
    const int width = spec_.width, targets = x.sets[0].count, neighbours = x.sets[1].count;
    const torch::Tensor t = Embed(x.sets[0], b_.sets[0]), n = Embed(x.sets[1], b_.sets[1]),
                        o = Embed(x.sets[2], b_.sets[2]);
    const torch::Tensor edges = TensorOf(x.edges, {targets, neighbours, spec_.edges});
    const torch::Tensor base = Dense(t, b_.edge_target).unsqueeze(1);
    const torch::Tensor from = torch::matmul(n, At(b_.edge_neighbour).t()).unsqueeze(0);
    const torch::Tensor m = torch::relu(torch::cat(
        {torch::matmul(edges, At(b_.edge_row).t()) + from + base, base + At(b_.edge_nobody).t()},
        1));
    torch::Tensor sent = t;
    if (targets > 0) {
      sent = torch::relu(Dense(torch::cat({t, m.mean(1), std::get<0>(m.max(1))}, 1), b_.update));
    }
    const auto with_nobody = [&](const torch::Tensor& rows, int s) {
      return torch::cat({rows, At(b_.sets[static_cast<std::size_t>(s)].nobody).t()}, 0);
    };
    const torch::Tensor all_t = with_nobody(sent, 0), all_n = with_nobody(n, 1),
                        all_o = with_nobody(o, 2);
    const torch::Tensor quality =
        TensorOf(x.sets[1].rows, {neighbours, spec_.neighbours}).select(1, spec_.quality);
    const torch::Tensor prior =
        torch::cat({torch::log(quality + 0.01), torch::zeros({1})}).unsqueeze(0);
    const torch::Tensor self = torch::relu(Dense(TensorOf(x.self, {1, spec_.self}), b_.self));
    const torch::Tensor joined =
        torch::cat({self, TensorOf(x.search, {1, spec_.search}), Attend(0, self, all_t, {}),
                    Attend(1, self, all_n, prior), Attend(2, self, all_o, {}),
                    std::get<0>(all_t.max(0, true)), std::get<0>(all_n.max(0, true))},
                   1);
    const torch::Tensor y = torch::relu(Dense(torch::relu(Dense(joined, b_.trunk1)), b_.trunk2));
    const torch::Tensor follows =
        torch::cat({TensorOf(x.sets[0].rows, {targets, spec_.targets}).select(1, spec_.follows),
                    torch::zeros({1})});
    const torch::Tensor choices =
        torch::matmul(all_t, torch::matmul(At(b_.pointer), y.t())).view({-1}) +
        follows * At(b_.follow).view({1});
    const torch::Tensor out = Dense(y, b_.head) + torch::matmul(all_t, At(b_.head_row).t());
    EXPECT_EQ(out.size(1), spec_.outputs);
    EXPECT_EQ(joined.size(1), spec_.joined());
    EXPECT_EQ(sent.size(1), width);
    return {choices, out};
  }

  agent::GraphSpec spec_;
};

TEST(GraphBatch, OutputsAndGradientsAreLibtorchs) {
  for (const agent::GraphSpec& spec : {SmallGraph(), agent::EntityGraphSpec(5)}) {
    const GraphBatch graph(spec);
    const std::vector<float> p = Draw(graph.parameters(), 0.3F, 1);
    const std::vector<DrawnRows> many = DrawMany(spec, 11);
    PackedRows x{RowSizes(spec)};
    for (const DrawnRows& auv : many) x.Add(auv.rows);
    const int choices = x.offset(0, x.rows()) + x.rows();
    const std::vector<float> d_choices = Draw(static_cast<std::size_t>(choices), 1.0F, 2);
    const std::vector<float> d_out =
        Draw(static_cast<std::size_t>(choices * spec.outputs), 1.0F, 3);
    GraphBatch::Workspace w;
    graph.Forward(p.data(), x, &w);
    std::vector<float> gradient(graph.parameters(), 0.0F);
    graph.Backward(p.data(), x, d_choices.data(), d_out.data(), &w, gradient.data());

    const TorchGraph reference(spec, p);
    torch::Tensor loss = torch::zeros({1});
    int at = 0;
    for (const DrawnRows& auv : many) {
      const auto [theirs, out] = reference.Forward(auv.rows);
      const int count = auv.rows.sets[0].count + 1;
      ASSERT_EQ(theirs.size(0), count);
      for (int k = 0; k < count; ++k) {
        const double c = theirs[k].item<double>();
        EXPECT_NEAR(w.choices()[at + k], c, 1e-4 * std::max(1.0, std::abs(c)));
        for (int i = 0; i < spec.outputs; ++i) {
          const double v = out[k][i].item<double>();
          EXPECT_NEAR(w.output()[(at + k) * spec.outputs + i], v,
                      1e-4 * std::max(1.0, std::abs(v)));
        }
      }
      loss = loss + (theirs * TensorOf(d_choices.data() + at, {count})).sum() +
             (out * TensorOf(d_out.data() + at * spec.outputs, {count, spec.outputs})).sum();
      at += count;
    }
    EXPECT_EQ(at, choices);
    loss.sum().backward();
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
      EXPECT_LT(error / largest, 5e-5) << "block " << b;
    }
  }
}

TEST(GraphBatch, ManyAuvsAtOnceGetWhatTheAgentComputesForOne) {
  const agent::GraphSpec spec = agent::EntityGraphSpec(5);
  const GraphBatch graph(spec);
  const std::vector<float> p = Draw(graph.parameters(), 0.1F, 4);
  const agent::GraphNetwork one(spec, p);
  const std::vector<DrawnRows> many = DrawMany(spec, 13);
  PackedRows x{RowSizes(spec)}, copy{RowSizes(spec)};
  for (const DrawnRows& auv : many) x.Add(auv.rows);
  for (int r = 0; r < x.rows(); ++r) copy.Add(x, r);
  GraphBatch::Workspace w;
  graph.Forward(p.data(), copy, &w);
  int at = 0;
  for (const DrawnRows& auv : many) {
    float choices[8], out[8 * 5];
    one.Forward(auv.rows, choices, out);
    for (int k = 0; k <= auv.rows.sets[0].count; ++k, ++at) {
      EXPECT_NEAR(choices[k], w.choices()[at], 1e-5);
      for (int i = 0; i < 5; ++i) EXPECT_NEAR(out[5 * k + i], w.output()[5 * at + i], 1e-5);
    }
  }
}

}  // namespace
}  // namespace stg::learn

#include "stg_agent/entities/graph_network.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "entities/entity_examples.hpp"
#include "stg_agent/entities/entity_policy.hpp"
#include "stg_agent/graph/features.hpp"

/// Tests of the network over the task graph with the knowledge of an AUV.
namespace stg::agent {
namespace {

constexpr int kOutputs = 5;

std::vector<float> DrawnNumbers(unsigned seed) {
  std::vector<float> p(EntityParameters(EntityNetwork::kGraph, kOutputs));
  Random random(seed, Stream::kInit, 0, 0, 0);
  for (float& x : p) x = static_cast<float>(0.2 * random.Normal());
  return p;
}

/// What an AUV knows of some neighbours and targets.
Entities MakeEntities(unsigned seed, int neighbours, int targets) {
  Entities e;
  BuildEntities(MakeExample(seed, neighbours).input(), &e);
  Random random(seed, Stream::kReset, 1, 0, 0);
  for (int t = 1; t < targets; ++t) {
    for (int k = 0; k < kTargetNumbers; ++k) {
      e.target[t][k] = e.target[0][k] + static_cast<float>(0.3 * random.Normal());
    }
    e.target[t][kTargetFollowed] = 0.0F;
    for (int j = 0; j < neighbours; ++j) {
      for (int k = 0; k < kEdgeNumbers; ++k) {
        e.edge[t][j][k] = e.edge[0][j][k] + static_cast<float>(0.3 * random.Normal());
      }
    }
  }
  e.targets = targets;
  return e;
}

/// The same rows and edges in another order.
Entities Reordered(const Entities& e, const std::vector<int>& targets,
                   const std::vector<int>& neighbours) {
  Entities y = e;
  for (int t = 0; t < e.targets; ++t) {
    const int from = targets[static_cast<std::size_t>(t)];
    std::copy_n(e.target[from], kTargetNumbers, y.target[t]);
    for (int j = 0; j < e.neighbours; ++j) {
      std::copy_n(e.edge[from][neighbours[static_cast<std::size_t>(j)]], kEdgeNumbers,
                  y.edge[t][j]);
    }
  }
  for (int j = 0; j < e.neighbours; ++j) {
    std::copy_n(e.neighbour[neighbours[static_cast<std::size_t>(j)]], kNeighbourNumbers,
                y.neighbour[j]);
  }
  return y;
}

struct Output {
  std::vector<float> choices, commands;  // [targets + 1], [targets + 1, outputs]
};

Output OutputOf(const GraphNetwork& network, const Entities& e) {
  const auto rows = static_cast<std::size_t>(e.targets + 1);
  Output y{std::vector<float>(rows), std::vector<float>(rows * kOutputs)};
  network.Forward(EntityGraphRows(e), y.choices.data(), y.commands.data());
  return y;
}

TEST(GraphNetwork, AnotherOrderOfRowsIsTheSameInThatOrder) {
  const GraphNetwork network(EntityGraphSpec(kOutputs), DrawnNumbers(4));
  const Entities e = MakeEntities(9, 7, 4);
  const std::vector<int> targets = {2, 0, 3, 1}, neighbours = {6, 2, 0, 5, 1, 4, 3};
  const Output ours = OutputOf(network, e);
  const Output theirs = OutputOf(network, Reordered(e, targets, neighbours));
  for (std::size_t t = 0; t < 5; ++t) {
    // The row of the search is the last one.
    const std::size_t from = t < 4 ? static_cast<std::size_t>(targets[t]) : 4;
    EXPECT_NEAR(theirs.choices[t], ours.choices[from], 5e-5F);
    for (std::size_t k = 0; k < kOutputs; ++k) {
      EXPECT_NEAR(theirs.commands[t * kOutputs + k], ours.commands[from * kOutputs + k], 5e-5F);
    }
  }
}

TEST(GraphNetwork, TurningTheWorldAboutTheVerticalChangesNothing) {
  const GraphNetwork network(EntityGraphSpec(kOutputs), DrawnNumbers(5));
  Entities north, turned;
  BuildEntities(MakeExample(3, 6).input(), &north);
  BuildEntities(MakeExample(3, 6, 2.0).input(), &turned);
  const Output ours = OutputOf(network, north), theirs = OutputOf(network, turned);
  for (std::size_t k = 0; k < ours.commands.size(); ++k) {
    EXPECT_NEAR(ours.commands[k], theirs.commands[k], 1e-4F);
  }
}

/// A second row for every neighbour changes no maximum, and no share of attention among neighbours.
/// It only makes the part of the row `nobody` smaller. If that row has no part, nothing changes.
TEST(GraphNetwork, EveryNeighbourTwiceChangesNothingWhereNobodyHasNoPart) {
  const GraphSpec spec = EntityGraphSpec(kOutputs);
  const GraphBlocks b(spec);
  std::vector<float> p = DrawnNumbers(6);
  const auto at = [&p](const PoolBlock& block, int row, int col) -> float& {
    return p[block.offset + static_cast<std::size_t>(row * block.cols + col)];
  };
  // Attention gives the row `nobody` a share of e^-50. Only in this row number 0 is zero.
  const PoolBlocks::Set& set = b.sets[1];
  for (int c = 0; c < spec.width; ++c) at(set.second.weight, 0, c) = 0.0F;
  at(set.second.bias, 0, 0) = 1.0F;
  std::fill_n(p.begin() + static_cast<std::ptrdiff_t>(set.nobody.offset), set.nobody.size(), 0.0F);
  const GraphBlocks::Attention& a = b.attention[1];
  for (int h = 0; h < spec.heads; ++h) {
    const int first = h * spec.width / spec.heads;
    for (int c = 0; c < spec.hidden; ++c) at(a.query, first, c) = 10.0F;
    for (int c = 0; c < spec.width; ++c) at(a.key, first, c) = c == 0 ? 10.0F : 0.0F;
  }
  // The network leaves out the means of messages and keeps the maxima.
  for (int r = 0; r < spec.width; ++r) {
    for (int c = spec.width; c < 2 * spec.width; ++c) at(b.update.weight, r, c) = 0.0F;
  }
  const GraphNetwork network(spec, p);
  const Entities once = MakeEntities(2, 5, 2);
  Entities twice = once;
  for (int j = 0; j < 5; ++j) {
    std::copy_n(once.neighbour[j], kNeighbourNumbers, twice.neighbour[5 + j]);
    for (int t = 0; t < 2; ++t) std::copy_n(once.edge[t][j], kEdgeNumbers, twice.edge[t][5 + j]);
  }
  twice.neighbours = 10;
  const Output ours = OutputOf(network, once), theirs = OutputOf(network, twice);
  for (std::size_t k = 0; k < ours.commands.size(); ++k) {
    EXPECT_NEAR(ours.commands[k], theirs.commands[k], 1e-4F);
  }
  Entities other = once;
  other.neighbour[1][0] += 1.0F;
  EXPECT_GT(std::abs(OutputOf(network, other).commands[0] - ours.commands[0]), 1e-4F);
}

TEST(GraphNetwork, ALinkOfNoQualityHasNextToNoShare) {
  const GraphSpec spec = EntityGraphSpec(kOutputs);
  std::vector<float> p = DrawnNumbers(7);
  const GraphBlocks b(spec);
  const auto zero = [&p](const PoolBlock& block) {
    std::fill_n(p.begin() + static_cast<std::ptrdiff_t>(block.offset), block.size(), 0.0F);
  };
  // Neighbours come in by attention only, and its shares depend on the prior only.
  for (const PoolBlock& block : {b.edge_neighbour, b.edge_row, b.attention[1].query}) zero(block);
  for (int r = 0; r < spec.hidden; ++r) {  // weights of the maxima over neighbours
    for (int c = spec.joined() - spec.width; c < spec.joined(); ++c) {
      p[b.trunk1.weight.offset + static_cast<std::size_t>(r * spec.joined() + c)] = 0.0F;
    }
  }
  std::fill_n(p.begin() + static_cast<std::ptrdiff_t>(b.prior.offset), b.prior.size(), 8.0F);
  const GraphNetwork network(spec, p);
  Entities e = MakeEntities(5, 2, 1), other = e;
  other.neighbour[1][0] += 1.0F;  // this row has another number
  const auto differ = [&](float quality) {
    e.neighbour[1][kNeighbourQuality] = other.neighbour[1][kNeighbourQuality] = quality;
    return std::abs(OutputOf(network, e).commands[0] - OutputOf(network, other).commands[0]);
  };
  EXPECT_GT(differ(1.0F), 1e-3F);
  EXPECT_LT(differ(0.0F), 1e-6F);
}

/// With these weights, the mean and the maximum of (q, effective, e) over messages give the six
/// numbers of Eq. 18 in the row of the target.
TEST(GraphNetwork, WithWeightsSetByHandMessagesYieldTheGraphSummary) {
  const GraphSpec spec = EntityGraphSpec(kOutputs);
  const GraphBlocks b(spec);
  std::vector<float> p(b.size, 0.0F);
  const auto at = [&p](const PoolBlock& block, int row, int col) -> float& {
    return p[block.offset + static_cast<std::size_t>(row * block.cols + col)];
  };
  constexpr float kSteep = 4096.0F;
  EntityExample x = MakeExample(6, 4);
  x.neighbours[2].sight.link_quality = 0.05;  // this link is not effective
  const PoolBlocks::Set& set = b.sets[1];
  at(set.first.weight, 0, kNeighbourQuality) = 1.0F;
  at(set.first.weight, 1, kNeighbourError) = 1.0F;
  // The difference of two ramps is a step at the threshold.
  at(set.first.weight, 2, kNeighbourQuality) = kSteep;
  at(set.first.bias, 2, 0) = -0.1F * kSteep;
  at(set.first.weight, 3, kNeighbourQuality) = kSteep;
  at(set.first.bias, 3, 0) = -0.1F * kSteep - 1.0F;
  at(set.second.weight, 0, 0) = 1.0F;
  at(set.second.weight, 1, 2) = 1.0F;
  at(set.second.weight, 1, 3) = -1.0F;
  at(set.second.weight, 2, 1) = 1.0F;
  for (int k = 0; k < spec.width; ++k) at(b.edge_neighbour, k, k) = 1.0F;
  // The row of the target takes the three means and the largest quality. The command shows them.
  for (int k = 0; k < 3; ++k) at(b.update.weight, k, spec.width + k) = 1.0F;
  at(b.update.weight, 3, 2 * spec.width) = 1.0F;
  for (int k = 0; k < 4; ++k) at(b.head_row, k, k) = 1.0F;

  const double others = x.model.run.agents - 1.0;
  double quality = 0.0, best = 0.0, effective = 0.0, error = 0.0;
  for (const EntityNeighbour& n : x.neighbours) {
    quality += n.sight.link_quality;
    best = std::max(best, n.sight.link_quality);
    error += n.sight.tracking_error;
    if (n.sight.link_quality > 0.1) effective += 1.0;
  }
  x.knowledge.effective_fraction = effective / others;
  x.knowledge.mean_quality = quality / others;
  x.knowledge.best_quality = best;
  x.knowledge.mean_neighbour_error = error / 4.0;
  double graph[kGraphNumbers];
  GraphSummary(x.model.observation, x.knowledge, &graph);
  Entities e;
  BuildEntities(x.input(), &e);
  const GraphNetwork network(spec, p);
  const Output y = OutputOf(network, e);
  const double rows = 4.0 + 1.0;  // the row `nobody` is zero, and the mean counts it
  // The advantage is the mean error of the neighbours less the AUV's own error, which is in `self`.
  // The role is its sign.
  EXPECT_NEAR(y.commands[1] * rows / others, graph[kGraphEffective], 1e-6);
  EXPECT_NEAR(y.commands[0] * rows / others, graph[kGraphMeanQuality], 1e-6);
  EXPECT_NEAR(y.commands[3], graph[kGraphBestQuality], 1e-6);
  EXPECT_NEAR(y.commands[2] * rows / 4.0, graph[kGraphNeighbourError], 1e-6);
  const double own = x.knowledge.error / x.model.observation.error_scale_m;
  EXPECT_NEAR(y.commands[2] * rows / 4.0 - own, graph[kGraphAdvantage], 1e-6);
  EXPECT_EQ(y.commands[2] * rows / 4.0 - own > 0.0 ? 1.0 : 0.0, graph[kGraphRole]);
}

TEST(GraphNetwork, AllZerosKeepTheTargetThatIsFollowed) {
  EntityPolicy::Parameters p;
  p.network = EntityNetwork::kGraph;
  p.numbers.assign(EntityParameters(p.network, kOutputs), 0.0F);
  p.log_std.assign(kOutputs, -1.0F);
  float command[kOutputs];
  EXPECT_EQ(EntityPolicy(p).Command(MakeEntities(1, 3, 4), command), 0);
  EXPECT_EQ(EntityPolicy(p).Command(MakeEntities(1, 3, 0), command), 0);
}

}  // namespace
}  // namespace stg::agent

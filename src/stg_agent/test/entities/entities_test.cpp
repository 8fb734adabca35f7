#include "stg_agent/entities/entities.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "entities/entity_examples.hpp"
#include "stg_agent/entities/entity_policy.hpp"
#include "stg_agent/graph/features.hpp"

namespace stg::agent {
namespace {

/// The numbers of all rows in a row.
std::vector<float> Flat(const Entities& e) {
  std::vector<float> all(e.self, e.self + kSelfNumbers);
  all.insert(all.end(), e.search, e.search + kSearchNumbers);
  for (int t = 0; t < e.targets; ++t) {
    all.insert(all.end(), e.target[t], e.target[t] + kTargetNumbers);
  }
  for (int n = 0; n < e.neighbours; ++n) {
    all.insert(all.end(), e.neighbour[n], e.neighbour[n] + kNeighbourNumbers);
    for (int t = 0; t < e.targets; ++t) {
      all.insert(all.end(), e.edge[t][n], e.edge[t][n] + kEdgeNumbers);
    }
  }
  for (int o = 0; o < e.obstacles; ++o) {
    all.insert(all.end(), e.obstacle[o], e.obstacle[o] + kObstacleNumbers);
  }
  return all;
}

Entities Build(const EntityExample& x) {
  Entities e;
  BuildEntities(x.input(), &e);
  return e;
}

/// Weights of a network, drawn from a seed.
std::vector<float> Weights(const PoolSpec& spec, unsigned seed) {
  std::vector<float> p(PoolBlocks(spec).size);
  Random random(seed, Stream::kInit, 0, 0, 0);
  for (float& x : p) x = static_cast<float>(0.2 * random.Normal());
  return p;
}

std::vector<float> OutputOf(const PoolNetwork& network, const Entities& e) {
  PoolRows sets[kEntitySets];
  EntityRows(e, &sets);
  std::vector<float> out(static_cast<std::size_t>(network.spec().outputs));
  network.Forward(e.self, e.search, sets, out.data());
  return out;
}

TEST(Entities, TurningTheWorldAboutTheVerticalChangesNothing) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const std::vector<float> north = Flat(Build(MakeExample(seed, 5)));
    for (const double turn : {0.7, 2.0, -1.9}) {
      const std::vector<float> turned = Flat(Build(MakeExample(seed, 5, turn)));
      ASSERT_EQ(north.size(), turned.size());
      for (std::size_t k = 0; k < north.size(); ++k) {
        EXPECT_NEAR(north[k], turned[k], 1e-5) << "seed " << seed << ", number " << k;
      }
    }
  }
}

TEST(Entities, HaveRowsForWhatThereIsAndEveryNumberIsFiniteAndClipped) {
  for (const int neighbours : {0, 1, 3, 16}) {
    for (const bool started : {false, true}) {
      EntityExample x = MakeExample(3, neighbours);
      x.belief.started = started;
      x.knowledge.distance = 1e6;
      const Entities e = Build(x);
      EXPECT_EQ(e.neighbours, neighbours);
      EXPECT_EQ(e.targets, started ? 1 : 0);
      EXPECT_EQ(e.obstacles, 3);
      for (const float v : Flat(e)) {
        EXPECT_TRUE(std::isfinite(v));
        EXPECT_LE(std::abs(v), kEntityClip);
      }
    }
  }
}

TEST(Entities, AnAuvAtRestLooksAlongItsHeading) {
  EntityExample x = MakeExample(1, 0);
  x.knowledge.v_WB_B = {};
  Orient(0.5, &x.knowledge);
  x.knowledge.r_BT_W = {100.0 * std::cos(0.5), 100.0 * std::sin(0.5), 0.0};
  const Entities e = Build(x);
  EXPECT_NEAR(e.target[0][0], 1.0, 1e-6);
  EXPECT_NEAR(e.target[0][1], 0.0, 1e-6);
}

TEST(Entities, ScalesReadAsStated) {
  const double metres[] = {60.0, 90.0, 120.0, 600.0, 2000.0};
  const double far[] = {0.26, 0.33, 0.38, 0.72, 1.0};
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(FarScale(metres[k]), far[k], 0.006);
  EXPECT_NEAR(BandScale(60.0, 90.0), -1.0, 1e-6);
  EXPECT_NEAR(BandScale(120.0, 90.0), 1.0, 1e-6);
  EXPECT_NEAR(AgeScale(5.0), 0.17, 0.005);
  EXPECT_NEAR(AgeScale(300.0), 1.0, 0.005);
  EXPECT_NEAR(DeviationScale(5.0), 0.13, 0.005);
  EXPECT_NEAR(DeviationScale(1000.0), 1.0, 0.005);
}

/// The search row of an AUV at (200, 100) m on a course of 90 deg. The datum of its target has the
/// given deviation. It is `ahead` in front of the AUV and `port` to its left.
std::vector<float> SearchRow(double ahead, double port, double std_m) {
  AgentModel m = FieldModel();
  m.workspace.half_extent_m = 6000.0;
  m.track.search_cell_m = 100.0;
  SearchMap map(m);
  map.Start({0, {200.0 - port, 100.0 + ahead, -40.0}, std_m});
  std::vector<float> row(kSearchNumbers);
  BuildSearchRow(map, {200.0, 100.0, -30.0}, 0.0, 1.0, 600.0, row.data());
  return row;
}

TEST(SearchRow, TellsInWhichSectorAndRingTheMassIs) {
  const struct {
    double ahead, port;
    std::size_t sector, ring;
  } cases[] = {{650.0, 0.0, 0, 1},  {0.0, 250.0, 2, 0},     {-250.0, 0.0, 4, 0},
               {0.0, -650.0, 6, 1}, {1000.0, 1000.0, 1, 2}, {-1000.0, -1000.0, 5, 2}};
  for (const auto& c : cases) {
    const std::vector<float> row = SearchRow(c.ahead, c.port, 50.0);
    const std::size_t at = c.ring * 8 + c.sector;
    EXPECT_GT(row[at], 0.95F) << at;
    float all = 0.0F;
    for (std::size_t k = 0; k < 24; ++k) all += row[k] * row[k];
    EXPECT_NEAR(all, 1.0F, 1e-4F);
    const double d = std::hypot(c.ahead, c.port);
    EXPECT_NEAR(row[24], d <= 450.0 ? 1.0 : row[24], 1e-3);
    EXPECT_NEAR(row[26], c.ahead / d, 0.3);
    EXPECT_NEAR(row[27], c.port / d, 0.3);
  }
}

TEST(SearchRow, EntropyIsOneOfAnEvenMapAndThatOfAGaussianElse) {
  EXPECT_NEAR(SearchRow(0.0, 0.0, 1e5)[25], 1.0, 1e-3);
  // The entropy of a Gaussian in the plane is ln(2 pi e s^2), with s in cells of 100 m.
  const double s = 3.0;
  EXPECT_NEAR(SearchRow(0.0, 0.0, 300.0)[25],
              std::log(2.0 * kPi * std::exp(1.0) * s * s) / std::log(1024.0), 2e-3);
}

TEST(Entities, OpposedObserversAreOneAxisAndSpreadOnesAreNone) {
  EntityExample x = MakeExample(1, 2);
  x.knowledge.r_BT_W = {100.0, 0.0, 0.0};
  x.memory.now = 70'000'000'000;
  x.memory.own_detection[0] = 65'000'000'000;
  for (EntityNeighbour& n : x.neighbours) {
    n.sight.r_BN_W = {200.0, 0.0, 0.0};  // it is on the other side of the target
  }
  dynamics::Detection sighting;
  sighting.stamp = 60'000'000'000;
  for (NeighbourState& r : x.reports) r.sightings.clear();
  x.reports[0].sightings.push_back(sighting);
  Entities e = Build(x);
  EXPECT_NEAR(e.target[0][24], 0.0, 1e-6);
  EXPECT_NEAR(e.target[0][25], 1.0, 1e-6);
  x.reports[1].sightings.push_back(sighting);
  x.neighbours[0].sight.r_BN_W = {150.0, 86.6025404, 0.0};
  x.neighbours[1].sight.r_BN_W = {150.0, -86.6025404, 0.0};
  e = Build(x);
  EXPECT_NEAR(e.target[0][24], 0.0, 1e-5);
  EXPECT_NEAR(e.target[0][25], 0.0, 1e-5);
}

TEST(PoolNetwork, DoesNotCareForTheOrderOfRows) {
  const PoolSpec spec = EntityActorSpec(5);
  const PoolNetwork network(spec, Weights(spec, 4));
  EntityExample x = MakeExample(9, 7);
  const Entities e = Build(x);
  std::reverse(x.neighbours.begin(), x.neighbours.end());
  const std::vector<float> ours = OutputOf(network, e), theirs = OutputOf(network, Build(x));
  for (std::size_t k = 0; k < ours.size(); ++k) EXPECT_NEAR(ours[k], theirs[k], 2e-5F);
  // In the agent's order, nearest first, the outputs are equal bit for bit.
  std::sort(x.neighbours.begin(), x.neighbours.end(),
            [](const auto& a, const auto& b) { return a.sight.distance_m < b.sight.distance_m; });
  const std::vector<float> sorted = OutputOf(network, Build(x));
  std::swap(x.neighbours[0], x.neighbours[5]);
  std::sort(x.neighbours.begin(), x.neighbours.end(),
            [](const auto& a, const auto& b) { return a.sight.distance_m < b.sight.distance_m; });
  const std::vector<float> again = OutputOf(network, Build(x));
  EXPECT_EQ(std::memcmp(sorted.data(), again.data(), sorted.size() * sizeof(float)), 0);
}

TEST(PoolNetwork, ARowTwiceChangesMeansAsOneMoreRowAndMaximaNotAtAll) {
  const PoolSpec spec = EntityActorSpec(5);
  const PoolNetwork network(spec, Weights(spec, 5));
  EntityExample x = MakeExample(2, 3);
  const auto pool = [&network](const Entities& e) {
    PoolRows sets[kEntitySets];
    EntityRows(e, &sets);
    std::vector<float> p(static_cast<std::size_t>(2 * 32 * kEntitySets));
    network.Pool(sets, p.data());
    return p;
  };
  const std::vector<float> three = pool(Build(x));
  const EntityNeighbour copy = x.neighbours[1];
  EntityExample one = x;
  one.neighbours = {copy};
  const std::vector<float> alone = pool(Build(one));
  EntityExample none = x;
  none.neighbours.clear();
  const std::vector<float> nobody = pool(Build(none));
  x.neighbours.push_back(copy);
  const std::vector<float> four = pool(Build(x));
  for (std::size_t k = 64; k < 96; ++k) {
    // The mean of `alone` is over two rows, its own and `nobody`.
    const float row = 2.0F * alone[k] - nobody[k];
    EXPECT_NEAR(four[k], (4.0F * three[k] + row) / 5.0F, 1e-5);
    EXPECT_EQ(four[k + 32], three[k + 32]);
  }
}

/// With these weights, the mean and the maximum of (q, effective, e) give the six numbers of Eq.
/// 18.
TEST(PoolNetwork, WithWeightsSetByHandPoolingYieldsTheGraphSummary) {
  const PoolSpec spec = EntityActorSpec(5);
  std::vector<float> p(PoolBlocks(spec).size, 0.0F);
  const PoolBlocks blocks(spec);
  const auto at = [&p](const PoolBlock& b, int row, int col) -> float& {
    return p[b.offset + static_cast<std::size_t>(row * b.cols + col)];
  };
  const PoolBlocks::Set& set = blocks.sets[1];
  constexpr float kSteep = 4096.0F;
  at(set.first.weight, 0, kNeighbourQuality) = 1.0F;
  // The difference of two steep ramps is a step.
  at(set.first.weight, 1, kNeighbourQuality) = kSteep;
  at(set.first.bias, 1, 0) = -0.1F * kSteep;
  at(set.first.weight, 2, kNeighbourQuality) = kSteep;
  at(set.first.bias, 2, 0) = -0.1F * kSteep - 1.0F;
  at(set.first.weight, 3, kNeighbourError) = 1.0F;
  at(set.second.weight, 0, 0) = 1.0F;
  at(set.second.weight, 1, 1) = 1.0F;
  at(set.second.weight, 1, 2) = -1.0F;
  at(set.second.weight, 2, 3) = 1.0F;
  const PoolNetwork network(spec, p);

  EntityExample x = MakeExample(6, 4);
  x.neighbours[2].sight.link_quality = 0.05;  // this link is not effective
  const double others = x.model.run.agents - 1.0;
  double quality = 0.0, best = 0.0, error = 0.0, effective = 0.0;
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
  const Entities e = Build(x);
  for (int k = 0; k < kGraphNumbers; ++k) {
    EXPECT_NEAR(e.self[kSelfGraph + k], graph[k], 1e-6) << k;
  }
  PoolRows sets[kEntitySets];
  EntityRows(e, &sets);
  std::vector<float> pooled(2 * 32 * kEntitySets);
  network.Pool(sets, pooled.data());
  const float* mean = pooled.data() + 64;
  const float* most = mean + 32;
  const double rows = 4.0 + 1.0;  // the row `nobody` is zero, and the mean counts it
  EXPECT_NEAR(mean[1] * rows / others, graph[kGraphEffective], 1e-6);
  EXPECT_NEAR(mean[0] * rows / others, graph[kGraphMeanQuality], 1e-6);
  EXPECT_NEAR(most[0], graph[kGraphBestQuality], 1e-6);
  EXPECT_NEAR(mean[2] * rows / 4.0, graph[kGraphNeighbourError], 1e-6);
  const double own = x.knowledge.error / x.model.observation.error_scale_m;
  EXPECT_NEAR(mean[2] * rows / 4.0 - own, graph[kGraphAdvantage], 1e-6);
  EXPECT_EQ(mean[2] * rows / 4.0 - own > 0.0 ? 1.0 : 0.0, graph[kGraphRole]);
}

}  // namespace
}  // namespace stg::agent

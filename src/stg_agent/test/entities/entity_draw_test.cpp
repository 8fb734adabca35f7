#include "stg_agent/entities/entity_draw.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "entities/entity_examples.hpp"

/// Exploration with a policy over entities.
namespace stg::agent {
namespace {

EntityPolicy PolicyOf(EntityNetwork network) {
  EntityPolicy::Parameters p;
  p.network = network;
  p.action = EntityAction::kLaw5;
  p.numbers.resize(EntityParameters(network, CommandSize(p.action)));
  Random random(3, Stream::kInit, 0, 0, 0);
  for (float& x : p.numbers) x = 0.1F * static_cast<float>(random.Normal());
  p.log_std = {-1.0F, -0.5F, -2.0F, 0.0F, -1.5F};
  return EntityPolicy(p);
}

Entities RowsOfExample() {
  Entities entities;
  BuildEntities(MakeExample(4, 3).input(), &entities);
  return entities;
}

TEST(EntityDraw, SharesAreTheSoftmaxAndDrawsFollowThem) {
  const float logits[4] = {0.0F, std::log(2.0F), std::log(4.0F), 0.0F};
  float log_shares[4];
  LogShares(logits, 4, log_shares);
  const double shares[4] = {0.125, 0.25, 0.5, 0.125};
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(std::exp(double{log_shares[k]}), shares[k], 1e-6);

  const float means[8] = {0.0F, 0.1F, 0.2F, 0.3F, 0.4F, 0.5F, 0.6F, 0.7F};
  const float log_std[2] = {-2.0F, -1.0F};
  CommandDistribution of;
  of.chooses = true;
  of.choices = 4;
  of.logits = logits;
  of.means = means;
  of.log_std = log_std;
  of.size = 2;
  constexpr int kDraws = 40000;
  double counts[4] = {}, squares = 0.0;
  for (std::uint32_t d = 0; d < kDraws; ++d) {
    Random random(1, Stream::kPolicy, 0, d, 0);
    int choice = -1;
    float command[2];
    const float log_density = DrawCommand(of, &random, &choice, command);
    ++counts[choice];
    double expected = std::log(shares[choice]);
    for (int k = 0; k < 2; ++k) {
      const double sigma = std::exp(double{log_std[k]});
      const double z = (double{command[k]} - double{means[2 * choice + k]}) / sigma;
      expected += std::log(std::exp(-0.5 * z * z) / (sigma * std::sqrt(2.0 * M_PI)));
      squares += z * z;
    }
    ASSERT_NEAR(log_density, expected, 1e-4);
  }
  // Five standard deviations of a share and of a mean of squares.
  for (int k = 0; k < 4; ++k) {
    const double spread = std::sqrt(shares[k] * (1.0 - shares[k]) / kDraws);
    EXPECT_NEAR(counts[k] / kDraws, shares[k], 5.0 * spread);
  }
  EXPECT_NEAR(squares / (2.0 * kDraws), 1.0, 5.0 * std::sqrt(1.0 / kDraws));
}

TEST(EntityDraw, LogDensityIsThatOfTheDraw) {
  const Entities entities = RowsOfExample();
  for (const auto network : {EntityNetwork::kPool, EntityNetwork::kGraph}) {
    const EntityPolicy policy = PolicyOf(network);
    float logits[kMostChoices], means[kMostChoices * kCommandNumbers];
    CommandDistribution of;
    of.chooses = network == EntityNetwork::kGraph;
    of.choices = policy.Choices(entities, logits, means);
    EXPECT_EQ(of.choices, of.chooses ? entities.targets + 1 : 1);
    of.logits = logits;
    of.means = means;
    of.log_std = policy.parameters().log_std.data();
    for (std::uint32_t d = 0; d < 50; ++d) {
      Random random(2, Stream::kPolicy, 0, d, 0);
      int choice = -1;
      float command[kCommandNumbers];
      const float log_density = DrawCommand(of, &random, &choice, command);
      EXPECT_NEAR(log_density, LogDensity(policy, entities, choice, command), 1e-4);
    }
  }
}

TEST(EntityDraw, CorrelatedNoiseHasTheSameDensityAndItsCorrelation) {
  const float mean = 0.3F, log_std = -1.0F;
  float noise = 0.0F;
  CommandDistribution of;
  of.means = &mean;
  of.log_std = &log_std;
  of.size = 1;
  of.keep = 0.8F;
  of.noise = &noise;
  constexpr int kBefore = 100, kDraws = 100000;
  double squares = 0.0, products = 0.0, last = 0.0;
  for (std::uint32_t d = 0; d < kBefore + kDraws; ++d) {
    Random random(4, Stream::kPolicy, 0, d, 0);
    int choice = -1;
    float command = 0.0F;
    const float log_density = DrawCommand(of, &random, &choice, &command);
    const double sigma = std::exp(double{log_std}), z = (double{command} - double{mean}) / sigma;
    EXPECT_NEAR(z, double{noise}, 1e-5);
    ASSERT_NEAR(log_density, std::log(std::exp(-0.5 * z * z) / (sigma * std::sqrt(2.0 * M_PI))),
                1e-4);
    if (d >= kBefore) {
      squares += z * z / kDraws;
      products += z * last / kDraws;
    }
    last = z;
  }
  // Means over an autoregression: five standard deviations, sqrt(2 (1 + k^2) / (1 - k^2) / n).
  const double spread = 5.0 * std::sqrt(2.0 * (1.0 + 0.64) / (1.0 - 0.64) / kDraws);
  EXPECT_NEAR(squares, 1.0, spread);
  EXPECT_NEAR(products, 0.8, spread);
}

TEST(EntityDraw, TheCommandIsTheOneOfTheLargestLogit) {
  const Entities entities = RowsOfExample();
  for (const auto network : {EntityNetwork::kPool, EntityNetwork::kGraph}) {
    const EntityPolicy policy = PolicyOf(network);
    float logits[kMostChoices], commands[kMostChoices * kCommandNumbers];
    float command[kCommandNumbers];
    const int count = policy.Choices(entities, logits, commands);
    const int choice = policy.Command(entities, command);
    for (int k = 0; k < count; ++k) EXPECT_LE(logits[k], logits[choice]);
    const float* chosen = commands + choice * kCommandNumbers;
    for (int k = 0; k < kCommandNumbers; ++k) EXPECT_EQ(command[k], chosen[k]);
  }
}

}  // namespace
}  // namespace stg::agent

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

RunConfig RunOfDecisions(double decision_s) {
  RunConfig run;
  run.time.dt_s = decision_s;
  run.time.decision_steps = 1;
  return run;
}

/// The noise of commands with a correlation time, divided by its deviation.
class NoisyCommands {
 public:
  NoisyCommands(double noise_time_s, std::uint32_t episode) : episode_(episode) {
    of_.means = &mean_;
    of_.log_std = &log_std_;
    of_.size = 1;
    of_.keep = NoiseKept(RunOfDecisions(1.0), EntityAction::kGuidance, noise_time_s);
    of_.noise = &noise_;
  }
  double Next() {
    Random random(4, Stream::kPolicy, episode_, command_++, 0);
    int choice = -1;
    float command = 0.0F;
    const float log_density = DrawCommand(of_, &random, &choice, &command);
    const double sigma = std::exp(double{log_std_}), z = (double{command} - double{mean_}) / sigma;
    EXPECT_NEAR(log_density, std::log(std::exp(-0.5 * z * z) / (sigma * std::sqrt(2.0 * M_PI))),
                1e-4);
    return z;
  }

 private:
  std::uint32_t episode_, command_ = 0;
  float mean_ = 0.3F, log_std_ = -1.0F;
  CommandNoise noise_;
  CommandDistribution of_;
};

// The closed form of the process: E[z(t) z(t + s)] = exp(-s / tau), with commands every 5 s.
TEST(EntityDraw, NoiseHasTheAutocorrelationOfItsTime) {
  constexpr int kDraws = 200000, kLags[] = {0, 1, 3, 12};
  for (const double tau_s : {0.0, 20.0, 60.0}) {
    NoisyCommands commands(tau_s, 0);
    std::vector<double> z(kDraws);
    for (double& x : z) x = commands.Next();
    const double keep = tau_s > 0.0 ? std::exp(-5.0 / tau_s) : 0.0;
    // A mean of products over such a process: five of its standard deviations, at most
    // sqrt(2 (1 + k^2) / (1 - k^2) / n).
    const double spread = 5.0 * std::sqrt(2.0 * (1.0 + keep * keep) / (1.0 - keep * keep) / kDraws);
    for (const int lag : kLags) {
      double products = 0.0;
      for (int k = lag; k < kDraws; ++k) products += z[k] * z[k - lag] / (kDraws - lag);
      const double expected = lag == 0 ? 1.0 : tau_s > 0.0 ? std::exp(-5.0 * lag / tau_s) : 0.0;
      EXPECT_NEAR(products, expected, spread) << tau_s << " s, lag " << lag;
    }
  }
}

TEST(EntityDraw, ACommandOfALongDecisionKeepsLessNoise) {
  EXPECT_NEAR(NoiseKept(RunOfDecisions(30.0), EntityAction::kGuidance, 60.0), std::exp(-0.5), 1e-6);
  EXPECT_NEAR(NoiseKept(RunOfDecisions(0.5), EntityAction::kGuidance, 60.0), std::exp(-5.0 / 60.0),
              1e-6);
  EXPECT_NEAR(NoiseKept(RunOfDecisions(0.5), EntityAction::kVelocity3, 60.0), std::exp(-0.5 / 60.0),
              1e-6);
}

// So the log density of the first command is not wrong either.
TEST(EntityDraw, NoiseHasVarianceOneFromTheFirstCommandOn) {
  constexpr int kEpisodes = 40000;
  double squares[3] = {}, products = 0.0;
  for (std::uint32_t e = 0; e < kEpisodes; ++e) {
    NoisyCommands commands(60.0, e);
    const double first = commands.Next(), second = commands.Next(), third = commands.Next();
    squares[0] += first * first / kEpisodes;
    squares[1] += second * second / kEpisodes;
    squares[2] += third * third / kEpisodes;
    products += first * third / kEpisodes;
  }
  const double spread = 5.0 * std::sqrt(2.0 / kEpisodes);
  for (const double square : squares) EXPECT_NEAR(square, 1.0, spread);
  EXPECT_NEAR(products, std::exp(-10.0 / 60.0), spread);
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

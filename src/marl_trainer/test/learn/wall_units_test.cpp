#include "marl_trainer/learn/nn/wall_units.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "auv_common/config/files.hpp"
#include "auv_common/numbers/attitude.hpp"
#include "stg_agent/graph/observation.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::learn {
namespace {

constexpr int kUnits = 40;
constexpr double kMargin = 0.015;

class WallUnits : public ::testing::Test {
 protected:
  WallUnits() : scenario_(LoadNamedScenario(config::ScenarioFolder(), "hard")), actor_(Actor()) {
    scenario_.world.workspace.half_extent_m = 2.0;
    std::mt19937 rng(5);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    for (int i = 0; i < scenario_.agent.observation_size(); ++i) {
      normaliser_.mean.push_back(0.4F * uniform(rng) - 0.2F);
      normaliser_.std.push_back(0.05F + 0.3F * uniform(rng));
    }
    normaliser_.clip = 1e3F;
    untouched_.resize(actor_.parameters());
    InitialiseOrthogonally(actor_.spec(), 3, 0, untouched_.data());
    placed_ = untouched_;
    PlaceWallUnits(actor_, {agent::kOwnPositionIndex, agent::kTargetOffsetIndex}, kMargin, 2.0,
                   normaliser_, placed_.data());
  }

  Mlp Actor() const {
    NetworkSpec spec;
    spec.inputs = scenario_.agent.observation_size();
    spec.hidden = {kUnits, 8};
    spec.activation = HiddenActivation::kRelu;
    spec.outputs = scenario_.world.control.action_size();
    return Mlp(spec);
  }

  /// The units of the first layer that the placement changed.
  std::vector<int> Placed() const {
    std::vector<int> units;
    for (int u = 0; u < kUnits; ++u) {
      const std::size_t w = actor_.weight_offset(0) + Row(u);
      if (!std::equal(placed_.begin() + w, placed_.begin() + w + Inputs(),
                      untouched_.begin() + w)) {
        units.push_back(u);
      }
    }
    return units;
  }

  /// Activations of the placed units at a position and a target offset [m], in ascending order.
  std::vector<double> Activations(const Vec3<double>& p_WB, const Vec3<double>& r_BT_W) const {
    agent::Knowledge<double> k;
    k.p_WB = p_WB;
    k.r_BT_W = r_BT_W;
    k.trig = {0.0, 1.0, 0.0, 1.0, 0.0, 1.0};
    k.R_WB = RotationOf(k.trig);
    std::vector<float> x(static_cast<std::size_t>(Inputs()));
    agent::BuildObservation(scenario_.model(), k, [&](int i, double value) {
      x[static_cast<std::size_t>(i)] = static_cast<float>(value);
    });
    normaliser_.Apply(x.data(), 1, x.data());
    std::vector<double> y;
    for (const int u : Placed()) {
      double sum = placed_[actor_.bias_offset(0) + static_cast<std::size_t>(u)];
      for (std::size_t i = 0; i < x.size(); ++i) {
        sum += static_cast<double>(placed_[actor_.weight_offset(0) + Row(u) + i] * x[i]);
      }
      y.push_back(std::max(sum, 0.0));
    }
    std::sort(y.begin(), y.end());
    return y;
  }

  std::ptrdiff_t Inputs() const { return actor_.inputs(); }
  std::size_t Row(int unit) const { return static_cast<std::size_t>(unit * Inputs()); }

  Scenario scenario_;
  Mlp actor_;
  Normaliser normaliser_;
  std::vector<float> untouched_, placed_;
};

TEST_F(WallUnits, RiseWithTheTargetsRoomToEachWall) {
  ASSERT_EQ(Placed().size(), static_cast<std::size_t>(kWallUnits));
  // The target is 1 cm from the wall +x, 2 m from the opposite wall and 5 cm from the wall -z.
  const std::vector<double> y = Activations({1.95, 0.3, -1.9}, {0.04, -0.1, -0.05});
  std::vector<double> expected(kWallUnits, 0.0);
  std::size_t n = 0;
  for (const double room : {0.01, 0.05}) {
    for (const double multiple : {0.5, 1.0, 2.0, 4.0}) {
      expected[n++] = std::max(0.0, 1.0 - room / (multiple * kMargin));
    }
  }
  std::sort(expected.begin(), expected.end());
  ASSERT_GT(expected.back(), 0.8);  // 1 - 0.01 / 0.06
  // This is single precision at the scale of 2 m / 7.5 mm.
  for (std::size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(y[i], expected[i], 1e-3) << i;
}

TEST_F(WallUnits, AreSilentFarFromWallsWhereverTheAuvIs) {
  // The AUV is near walls, the target is not.
  for (const double y : Activations({1.99, -1.99, 1.99}, {-0.2, 0.2, -0.2})) EXPECT_EQ(y, 0.0);
}

TEST_F(WallUnits, TakeThePlaceOfTheUnitsThatSayLeastAndStartUnheard) {
  const Mlp& actor = actor_;
  const int next = actor.spec().layer_outputs(1);
  const std::vector<int> units = Placed();
  const auto says = [&](int unit) {
    double in = 0.0, out = 0.0;
    for (std::ptrdiff_t i = 0; i < Inputs(); ++i) {
      in += std::pow(untouched_[Row(unit) + static_cast<std::size_t>(i)], 2);
    }
    for (int v = 0; v < next; ++v) {
      out += std::pow(
          untouched_[actor.weight_offset(1) + static_cast<std::size_t>(v * kUnits + unit)], 2);
    }
    return in * out;
  };
  double loudest_placed = 0.0, quietest_kept = 1e9;
  for (int u = 0; u < kUnits; ++u) {
    const bool placed = std::find(units.begin(), units.end(), u) != units.end();
    if (placed) {
      loudest_placed = std::max(loudest_placed, says(u));
    } else {
      quietest_kept = std::min(quietest_kept, says(u));
    }
    for (int v = 0; v < next; ++v) {
      const std::size_t w = actor.weight_offset(1) + static_cast<std::size_t>(v * kUnits + u);
      EXPECT_EQ(placed_[w], placed ? 0.0F : untouched_[w]);
    }
  }
  EXPECT_LE(loudest_placed, quietest_kept * (1.0 + 1e-6));
  // Nothing behind the two layers changes.
  EXPECT_TRUE(std::equal(placed_.begin() + static_cast<std::ptrdiff_t>(actor.bias_offset(1)),
                         placed_.end(),
                         untouched_.begin() + static_cast<std::ptrdiff_t>(actor.bias_offset(1))));
}

}  // namespace
}  // namespace stg::learn

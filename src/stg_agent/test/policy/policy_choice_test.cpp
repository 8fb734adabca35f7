#include <onnx/checker.h>
#include <onnx/onnx_pb.h>

#include <algorithm>
#include <cstring>

#include "auv_common/error.hpp"
#include "policy/policy_files.hpp"

/// Policies of Q-networks, and policies with one network per AUV.
namespace stg::agent {
namespace {

/// A policy whose heads choose from 5 rows of `width` numbers.
Policy::Parameters RandomChoice(int heads, int width, unsigned seed) {
  constexpr int kRows = 5;
  Policy::Parameters p = RandomParameters({8, 16, heads * kRows}, Policy::Activation::kRelu, seed);
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  p.choices = Eigen::MatrixXf::NullaryExpr(kRows, width, [&] { return uniform(rng); });
  p.log_std = Eigen::VectorXf::Constant(heads * width, -20.0F);
  return p;
}

TEST_F(PolicyTest, EachHeadTakesTheRowItValuesMost) {
  for (const auto& [heads, width] : {std::pair(3, 1), std::pair(1, 3), std::pair(2, 2)}) {
    const Policy::Parameters p = RandomChoice(heads, width, 3);
    const Policy policy(p);
    ASSERT_EQ(policy.action_size(), heads * width);
    for (unsigned k = 0; k < 20; ++k) {
      const std::vector<float> o = RandomObservation(8, k);
      Eigen::VectorXf x = Eigen::Map<const Eigen::VectorXf>(o.data(), 8);
      x = ((x - p.input_mean).array() / p.input_std.array()).max(-10.0F).min(10.0F);
      x = (p.layers[0].weight * x + p.layers[0].bias).array().max(0.0F);
      x = p.layers[1].weight * x + p.layers[1].bias;
      std::vector<float> action(static_cast<std::size_t>(heads * width));
      policy.Mean(o.data(), action.data());
      for (int h = 0; h < heads; ++h) {
        Eigen::Index best = 0;
        x.segment(h * 5, 5).maxCoeff(&best);
        for (int d = 0; d < width; ++d) {
          EXPECT_EQ(action[static_cast<std::size_t>(h * width + d)], 0.75F * p.choices(best, d));
        }
      }
    }
  }
}

TEST_F(PolicyTest, ChoicesSurviveTheFile) {
  for (const auto& [heads, width] : {std::pair(3, 1), std::pair(1, 3)}) {
    const Policy::Parameters p = RandomChoice(heads, width, 3);
    Policy(p).SaveOnnx(Path("p.onnx"));
    const Policy loaded = Policy::LoadOnnx(Path("p.onnx"));
    EXPECT_EQ(loaded.parameters().choices, p.choices);
    EXPECT_EQ(loaded.parameters().layers.back().weight, p.layers.back().weight);
    EXPECT_EQ(loaded.action_size(), 3);
    onnx::ModelProto model;
    ASSERT_TRUE(model.ParseFromString(Bytes(Path("p.onnx"))));
    EXPECT_NO_THROW(onnx::checker::check_model(model));
  }
}

TEST_F(PolicyTest, ChangedChoicesNeverCrashAndNeverChangeTheNumbers) {
  const Policy good(RandomChoice(3, 1, 1));
  good.SaveOnnx(Path("good.onnx"));
  const std::string bytes = Bytes(Path("good.onnx"));
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    Write(Path("cut.onnx"), bytes.substr(0, size));
    EXPECT_THROW(Policy::LoadOnnx(Path("cut.onnx")), UserError) << size;
  }
  ExpectChangedBytesRefusedOrHarmless(good);
}

TEST_F(PolicyTest, ChoicesThatDoNotFitAreRefused) {
  Policy::Parameters p = RandomChoice(3, 1, 1);
  p.choices.conservativeResize(4, 1);
  EXPECT_THROW(Policy{p}, UserError);
  p = RandomChoice(3, 1, 1);
  p.choices(2, 0) = 1.5F;
  EXPECT_THROW(Policy{p}, UserError);
  p = RandomChoice(3, 1, 1);
  p.log_std = Eigen::VectorXf::Zero(15);
  EXPECT_THROW(Policy{p}, UserError);
}

TEST_F(PolicyTest, AnAuvFindsItsOwnFileWhereThereIsNoneForAll) {
  const std::string all = Path("p.onnx");
  EXPECT_EQ(PolicyFileOf(all, 1), all);
  Write(Path("p_1.onnx"), "");
  EXPECT_EQ(PolicyFileOf(all, 1), Path("p_1.onnx"));
  EXPECT_EQ(PolicyFileOf(all, 0), all);
  Write(Path("p_0.onnx"), "");
  try {
    PolicyFileOf(all, 4);
    FAIL() << "policies of fewer AUVs";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("no p_4.onnx"), std::string::npos) << error.what();
  }
  Write(all, "");
  EXPECT_EQ(PolicyFileOf(all, 1), all);
}

}  // namespace
}  // namespace stg::agent

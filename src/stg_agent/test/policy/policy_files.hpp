/// What the tests of policies and of their files share.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "stg_agent/policy/policy.hpp"

namespace stg::agent {

/// A network of the given layer sizes with random weights and complete metadata.
inline Policy::Parameters RandomParameters(const std::vector<int>& sizes,
                                           Policy::Activation activation, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<float> normal;
  const auto draw = [&](float scale) { return [&, scale] { return scale * normal(rng); }; };
  Policy::Parameters p;
  p.input_mean = Eigen::VectorXf::NullaryExpr(sizes.front(), draw(1.0F));
  p.input_std = Eigen::VectorXf::NullaryExpr(sizes.front(), draw(1.0F)).array().abs() + 0.01F;
  p.activation = activation;
  for (std::size_t l = 1; l < sizes.size(); ++l) {
    const float gain = 1.0F / std::sqrt(static_cast<float>(sizes[l - 1]));
    Policy::Layer layer;
    layer.weight = Eigen::MatrixXf::NullaryExpr(sizes[l], sizes[l - 1], draw(gain));
    layer.bias = Eigen::VectorXf::NullaryExpr(sizes[l], draw(0.1F));
    p.layers.push_back(layer);
  }
  p.log_std = Eigen::VectorXf::Constant(sizes.back(), -1.2345678F);
  p.metadata.id = "test";
  p.metadata.observation_layout = ObservationLayout(ObservationConfig());
  p.metadata.action_interface = "velocity3";
  p.metadata.action_scale = 0.75;
  p.metadata.scenario_hash = "0123456789abcdef";
  p.metadata.training_step = 123456789;
  p.metadata.seed = 18446744073709551615ULL;
  p.metadata.metrics = {{"return", "1040.5"}};
  return p;
}

inline std::vector<float> RandomObservation(int size, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<float> normal(0.0F, 2.0F);
  std::vector<float> o(static_cast<std::size_t>(size));
  for (float& v : o) v = normal(rng);
  return o;
}

/// Each test has its own folder.
class PolicyTest : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  std::string Bytes(const std::string& path) const {
    std::ifstream in(path, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }
  void Write(const std::string& path, const std::string& bytes) const {
    std::ofstream(path, std::ios::binary) << bytes;
  }

  /// Changes a byte of the policy's file, a thousand times. A file that can still be read must fly
  /// as before.
  void ExpectChangedBytesRefusedOrHarmless(const Policy& good) const {
    good.SaveOnnx(Path("good.onnx"));
    const std::string bytes = Bytes(Path("good.onnx"));
    const std::vector<float> o = RandomObservation(good.observation_size(), 1);
    const auto mean = [&o](const Policy& policy) {
      std::vector<float> action(static_cast<std::size_t>(policy.action_size()));
      policy.Mean(o.data(), action.data());
      return action;
    };
    std::mt19937 rng(1);
    for (int k = 0; k < 1000; ++k) {
      std::string changed = bytes;
      changed[rng() % changed.size()] = static_cast<char>(rng());
      Write(Path("changed.onnx"), changed);
      try {
        const std::vector<float> expected = mean(good);
        const std::vector<float> read = mean(Policy::LoadOnnx(Path("changed.onnx")));
        ASSERT_EQ(read.size(), expected.size()) << k;
        EXPECT_EQ(std::memcmp(read.data(), expected.data(), read.size() * sizeof(float)), 0) << k;
      } catch (const UserError&) {
      }
    }
  }

  const TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
};

}  // namespace stg::agent

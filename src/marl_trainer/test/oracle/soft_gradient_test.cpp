#include <gtest/gtest.h>
#include <torch/nn/functional/activation.h>

#include <cmath>
#include <random>

#include "marl_trainer/learn/algorithms/masac/squashed_gaussian.hpp"
#include "marl_trainer/learn/algorithms/off_policy/joint_critics.hpp"
#include "oracle/torch_network.hpp"

/// Compares the hand-made derivatives of off-policy methods with libtorch's automatic
/// differentiation.
namespace stg::learn {
namespace {

std::vector<float> Normals(std::size_t count, float scale, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<float> normal;
  std::vector<float> v(count);
  for (float& x : v) x = scale * normal(rng);
  return v;
}

torch::Tensor Rows(std::vector<float>& v, std::int64_t rows) {
  return torch::from_blob(v.data(), {rows, static_cast<std::int64_t>(v.size()) / rows},
                          torch::kFloat)
      .clone();
}

TEST(SquashedGaussian, DensityAndGradientAreThoseOfAutomaticDifferentiation) {
  const int rows = 50, size = 3;
  const LogStdRange range{-4.0F, 1.0F};
  std::vector<float> outputs = Normals(rows * 2 * size, 1.0F, 1);
  std::vector<float> noise = Normals(rows * size, 1.0F, 2);
  std::vector<float> d_action = Normals(rows * size, 1.0F, 3);
  const float d_log_prob = 0.3F;

  const torch::Tensor x = Rows(outputs, rows).requires_grad_(true);
  const torch::Tensor log_std =
      range.lo + 0.5 * (range.hi - range.lo) * (1 + torch::tanh(x.slice(1, size)));
  const torch::Tensor z = Rows(noise, rows);
  const torch::Tensor u = x.slice(1, 0, size) + log_std.exp() * z;
  const torch::Tensor action = torch::tanh(u);
  const torch::Tensor slope = 2 * (std::log(2.0) - u - torch::nn::functional::softplus(-2 * u));
  const torch::Tensor log_prob = (-0.5 * z * z - log_std - 0.5 * std::log(2 * M_PI) - slope).sum(1);
  ((action * Rows(d_action, rows)).sum() + d_log_prob * log_prob.sum()).backward();

  for (int r = 0; r < rows; ++r) {
    std::vector<float> a(size), d(2 * size);
    const float* out = outputs.data() + r * 2 * size;
    const float density = SquashedSample(range, out, noise.data() + r * size, size, a.data());
    EXPECT_NEAR(density, log_prob[r].item<float>(), 1e-4 * (1.0 + std::abs(density)));
    SquashedGradient(range, out, noise.data() + r * size, a.data(), d_action.data() + r * size,
                     d_log_prob, size, d.data());
    for (int k = 0; k < size; ++k) {
      EXPECT_NEAR(a[static_cast<std::size_t>(k)], action[r][k].item<float>(), 1e-6);
    }
    for (int k = 0; k < 2 * size; ++k) {
      EXPECT_NEAR(d[static_cast<std::size_t>(k)], x.grad()[r][k].item<float>(), 2e-5);
    }
  }
}

TEST(SquashedGaussian, DensityIntegratesToOne) {
  const LogStdRange range{-2.0F, 1.0F};
  const float outputs[] = {0.4F, 0.2F};
  const float sigma = std::exp(SquashedLogStd(range, outputs[1]));
  double mass = 0.0;
  constexpr int kCells = 20000;
  for (int i = 0; i < kCells; ++i) {
    const double a = 2.0 * (i + 0.5) / kCells - 1.0;
    const auto noise = static_cast<float>((std::atanh(a) - 0.4) / static_cast<double>(sigma));
    float action = 0.0F;
    mass += std::exp(static_cast<double>(SquashedSample(range, outputs, &noise, 1, &action))) *
            2.0 / kCells;
  }
  EXPECT_NEAR(mass, 1.0, 1e-3);
}

TEST(JointCritics, GradientsAreThoseOfAutomaticDifferentiation) {
  Problem problem;
  problem.agents = 3;
  problem.state_size = 11;
  problem.action_size = 2;
  ReplayOptions options;
  options.critic_hidden = {32, 24};
  const int rows = 40, joint = 6;
  JointCritics critics(problem, options, 2, 5);
  const std::vector<float> shake = Normals(critics.parameters().size(), 0.1F, 1);
  for (std::size_t i = 0; i < shake.size(); ++i) critics.parameters()[i] += shake[i];
  ReplayBatch batch(problem, rows);
  batch.count = rows;
  batch.states = Normals(batch.states.size(), 1.0F, 2);
  batch.actions = Normals(batch.actions.size(), 0.5F, 3);
  std::vector<float> targets = Normals(rows, 1.0F, 4);
  JointCritics::Scratch scratch(critics, rows);

  const torch::Tensor actions = Rows(batch.actions, rows).requires_grad_(true);
  const torch::Tensor inputs =
      torch::cat({Rows(batch.states, rows), options.action_gain * actions}, 1);
  std::vector<TorchNetwork> networks;
  std::vector<torch::Tensor> values;
  const std::size_t size = critics.network().parameters();
  for (std::size_t k = 0; k < 2; ++k) {
    networks.emplace_back(critics.network().spec());
    SetParameters(critics.parameters().data() + k * size, networks[k].get());
    values.push_back(networks[k]->forward(inputs).squeeze(1));
  }
  // The derivative of the smaller value in the actions.
  const float weight = -0.25F;
  const torch::Tensor smallest = torch::min(values[0], values[1]);
  (weight * smallest.sum()).backward({}, true);
  std::vector<float> value(rows), d_actions(static_cast<std::size_t>(rows * joint));
  critics.ActionGradient(batch.states.data(), batch.actions.data(), rows, weight, true, &scratch,
                         value.data(), d_actions.data());
  const double largest = actions.grad().abs().max().item<double>();
  for (int r = 0; r < rows; ++r) {
    EXPECT_NEAR(value[static_cast<std::size_t>(r)], smallest[r].item<float>(), 1e-5);
    for (int a = 0; a < joint; ++a) {
      EXPECT_NEAR(d_actions[static_cast<std::size_t>(r * joint + a)],
                  actions.grad()[r][a].item<float>(), 1e-5 * largest);
    }
  }
  // The derivative of the squared errors in the parameters.
  for (auto& network : networks) network->zero_grad();
  const torch::Tensor t = torch::from_blob(targets.data(), {rows}, torch::kFloat).clone();
  const torch::Tensor squares = ((values[0] - t).pow(2) + (values[1] - t).pow(2)).sum();
  (0.1 * squares).backward();
  std::vector<float> gradient(2 * size, 0.0F), expected(2 * size, 0.0F);
  const double sum = critics.AddGradient(batch, targets.data(), 0.1F, &scratch, gradient.data());
  for (std::size_t k = 0; k < 2; ++k) {
    AddGradients(networks[k].get(), expected.data() + k * size);
  }
  EXPECT_NEAR(sum, squares.item<double>() / 2, 1e-3);
  double miss = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    miss = std::max(miss, static_cast<double>(std::abs(gradient[i] - expected[i])));
    scale = std::max(scale, static_cast<double>(std::abs(expected[i])));
  }
  EXPECT_LT(miss, 1e-5 * scale);
}

}  // namespace
}  // namespace stg::learn

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "draw.hpp"
#include "marl_trainer/learn/buffers/gae.hpp"
#include "marl_trainer/learn/nn/adam.hpp"
#include "marl_trainer/learn/nn/blas.hpp"
#include "marl_trainer/learn/nn/mlp.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {
namespace {

TEST(Blas, ProductsOfEveryOrientationMatchTheDefinition) {
  const int m = 5, n = 7, k = 3;
  std::vector<float> a = Draw(m * k, 1.0F, 1), b = Draw(k * n, 1.0F, 2);
  for (const bool ta : {false, true}) {
    for (const bool tb : {false, true}) {
      std::vector<float> c(m * n, 1.0F);
      Multiply(ta, tb, m, n, k, a.data(), b.data(), 0.5F, c.data());
      for (int i = 0; i < m; ++i) {
        for (int j = 0; j < n; ++j) {
          float sum = 0.5F;
          for (int q = 0; q < k; ++q) {
            sum += a[static_cast<std::size_t>(ta ? q * m + i : i * k + q)] *
                   b[static_cast<std::size_t>(tb ? j * k + q : q * n + j)];
          }
          EXPECT_NEAR(c[static_cast<std::size_t>(i * n + j)], sum, 1e-5);
        }
      }
    }
  }
}

TEST(NetworkSpec, InitialWeightsAreOrthogonalWithTheStatedGain) {
  NetworkSpec spec;
  spec.inputs = 20;
  spec.hidden = {32, 8};
  spec.outputs = 3;
  spec.activation = HiddenActivation::kRelu;
  spec.output_gain = 0.01F;
  const Mlp mlp(spec);
  std::vector<float> p(spec.parameters(), 7.0F);
  ASSERT_EQ(p.size(), mlp.parameters());
  InitialiseOrthogonally(spec, 7, 0, p.data());
  const double gains[] = {std::sqrt(2.0), std::sqrt(2.0), 0.01};
  for (int l = 0; l < 3; ++l) {
    using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const int rows = spec.layer_outputs(l), cols = spec.layer_inputs(l);
    const Eigen::MatrixXd w =
        Eigen::Map<const RowMajor>(p.data() + mlp.weight_offset(l), rows, cols).cast<double>();
    const Eigen::MatrixXd tall = rows <= cols ? Eigen::MatrixXd(w.transpose()) : w;
    const Eigen::MatrixXd gram = tall.transpose() * tall;
    const int small = std::min(rows, cols);
    const double error = (gram - gains[l] * gains[l] * Eigen::MatrixXd::Identity(small, small))
                             .cwiseAbs()
                             .maxCoeff();
    EXPECT_LT(error, 1e-5) << l;
    for (int i = 0; i < rows; ++i) {
      EXPECT_EQ(p[mlp.bias_offset(l) + static_cast<std::size_t>(i)], 0.0F);
    }
  }
}

TEST(Adam, FirstStepsAreThoseOfTheFormula) {
  AdamState state(2);
  std::vector<float> p{1.0F, -2.0F};
  const float gradient[] = {0.5F, 100.0F};
  const double lr = 0.1, eps = 1e-5;
  double m = 0.0, v = 0.0, expected = 1.0;
  for (int step = 1; step <= 3; ++step) {
    Adam(eps, &state).Apply(0, 2, lr, 0.5F, gradient, p.data());
    const double g = 0.25;  // half of the gradient
    m = 0.9 * m + 0.1 * g;
    v = 0.999 * v + 0.001 * g * g;
    expected -= lr * (m / (1.0 - std::pow(0.9, step))) /
                (std::sqrt(v / (1.0 - std::pow(0.999, step))) + eps);
    EXPECT_NEAR(p[0], expected, 1e-5);
    // A constant gradient moves every parameter by the learning rate.
    EXPECT_NEAR(p[1], -2.0 - step * lr, 1e-4);
  }
  EXPECT_EQ(state.steps, 3);
  EXPECT_NEAR(GradientNorm(gradient, 0, 2), std::sqrt(10000.25), 1e-9);
  EXPECT_NEAR(GradientNorm(gradient, 1, 2), 100.0, 1e-9);
  EXPECT_FLOAT_EQ(ShrinkTo(5.0, 10.0), 0.5F);
  EXPECT_FLOAT_EQ(ShrinkTo(5.0, 1.0), 1.0F);
}

TEST(Gae, MatchesHandComputedSegmentWithTruncation) {
  // gamma = 0.5, lambda = 0.5. Step 1 ends an episode. The value of its last state is 8.
  const float rewards[] = {1, 2, 3}, values[] = {10, 20, 30}, final_values[] = {-99, 8, -99};
  const std::uint8_t done[] = {0, 1, 0};
  float advantages[3];
  GeneralisedAdvantages(rewards, values, done, final_values, 40.0F, 3, 1, 0.5F, 0.5F, advantages);
  EXPECT_FLOAT_EQ(advantages[2], 3 + 0.5F * 40 - 30);                // -7
  EXPECT_FLOAT_EQ(advantages[1], 2 + 0.5F * 8 - 20);                 // -14, without step 2
  EXPECT_FLOAT_EQ(advantages[0], 1 + 0.5F * 20 - 10 + 0.25F * -14);  // -2.5
}

TEST(Gae, LambdaOneIsTheDiscountedReturn) {
  const int steps = 6;
  const std::vector<float> r = Draw(steps, 1.0F, 1), v = Draw(steps, 1.0F, 2);
  const std::vector<std::uint8_t> done(steps, 0);
  std::vector<float> advantages(2 * steps), r2(2 * steps), v2(2 * steps);
  for (std::size_t t = 0; t < steps; ++t) {
    r2[2 * t] = r[t];
    v2[2 * t] = v[t];
  }
  const std::vector<std::uint8_t> done2(2 * steps, 0);
  GeneralisedAdvantages(r2.data(), v2.data(), done2.data(), v2.data(), 2.0F, steps, 2, 0.9F, 1.0F,
                        advantages.data());
  double expected = 2.0;
  for (int t = steps - 1; t >= 0; --t) {
    const auto i = static_cast<std::size_t>(t);
    expected = static_cast<double>(r[i]) + 0.9 * expected;
    EXPECT_NEAR(advantages[2 * i] + v[i], expected, 1e-5);
  }
}

TEST(RunningMoments, AnyGroupingGivesTheMomentsOfAllData) {
  const int size = 3, rows = 1000;
  std::vector<float> x = Draw(size * rows, 1.0F, 1);
  // The numbers are far from zero. There the naive sum of squares fails in single precision.
  for (float& v : x) v += 1000.0F;
  RunningMoments a(size), b(size), c(size);
  a.Add(x.data(), 1);
  a.Add(x.data() + size, 499);
  b.Add(x.data() + 500 * size, 300);
  c.Add(x.data() + 800 * size, 200);
  b.Merge(c);
  RunningMoments empty(size);
  a.Merge(empty);
  empty.Merge(a);
  empty.Merge(b);
  EXPECT_EQ(empty.count(), rows);
  for (int i = 0; i < size; ++i) {
    double mean = 0.0, variance = 0.0;
    for (int r = 0; r < rows; ++r) mean += x[static_cast<std::size_t>(r * size + i)] / double(rows);
    for (int r = 0; r < rows; ++r) {
      variance += std::pow(x[static_cast<std::size_t>(r * size + i)] - mean, 2) / rows;
    }
    EXPECT_NEAR(empty.mean(i), mean, 1e-9);
    EXPECT_NEAR(empty.variance(i), variance, 1e-9);
  }
  RunningMoments loaded(size);
  loaded.Load(empty.Save());
  EXPECT_EQ(loaded.Save(), empty.Save());
  const double variance = empty.variance(0);
  empty.LimitCount(10.0);
  EXPECT_EQ(empty.count(), 10.0);
  EXPECT_DOUBLE_EQ(empty.variance(0), variance);
}

TEST(Normaliser, ConstantComponentsAreNotBlownUpAndOutliersAreClipped) {
  RunningMoments moments(2);
  const float x[] = {1, 5, 3, 5};
  moments.Add(x, 2);
  const Normaliser normaliser = Normaliser::From(moments, 0.01F, 10.0F);
  const float in[] = {4, 5.05F, 1000, 4};
  float out[4];
  normaliser.Apply(in, 2, out);
  EXPECT_FLOAT_EQ(out[0], 2.0F);
  EXPECT_NEAR(out[1], 5.0F, 1e-3);
  EXPECT_FLOAT_EQ(out[2], 10.0F);
  EXPECT_FLOAT_EQ(out[3], -10.0F);
}

}  // namespace
}  // namespace stg::learn

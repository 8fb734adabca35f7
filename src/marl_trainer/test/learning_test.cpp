#include <gtest/gtest.h>
#include <torch/torch.h>

#include <atomic>
#include <cmath>
#include <random>
#include <stdexcept>

#include "auv_common/error.hpp"
#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/learn/algorithms/mappo/gae.hpp"
#include "marl_trainer/learn/algorithms/mappo/ppo.hpp"
#include "marl_trainer/learn/nn/blas.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {
namespace {

std::vector<float> Draw(std::size_t count, float scale, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<float> normal;
  std::vector<float> v(count);
  for (float& x : v) x = scale * normal(rng);
  return v;
}

torch::Tensor View(std::vector<float>& v, std::vector<std::int64_t> shape) {
  return torch::from_blob(v.data(), shape, torch::kFloat).clone();
}

/// The network's parameters as libtorch leaves: weight and bias of each layer.
std::vector<torch::Tensor> Leaves(const Mlp& mlp, const float* parameters) {
  std::vector<torch::Tensor> leaves;
  for (int l = 0; l < mlp.layers(); ++l) {
    float* p = const_cast<float*>(parameters);
    leaves.push_back(torch::from_blob(p + mlp.weight_offset(l),
                                      {mlp.layer_outputs(l), mlp.layer_inputs(l)}, torch::kFloat)
                         .clone()
                         .requires_grad_(true));
    leaves.push_back(torch::from_blob(p + mlp.bias_offset(l), {mlp.layer_outputs(l)}, torch::kFloat)
                         .clone()
                         .requires_grad_(true));
  }
  return leaves;
}

torch::Tensor TorchForward(const Mlp& mlp, const std::vector<torch::Tensor>& leaves,
                           torch::Tensor x) {
  for (std::size_t l = 0; l < leaves.size(); l += 2) {
    x = torch::nn::functional::linear(x, leaves[l], leaves[l + 1]);
    if (l + 2 < leaves.size()) {
      x = mlp.activation() == HiddenActivation::kTanh ? torch::tanh(x) : torch::relu(x);
    }
  }
  return x;
}

/// Largest difference between a flat gradient and libtorch's, relative to the
/// largest component.
double GradientError(const Mlp& mlp, const std::vector<torch::Tensor>& leaves,
                     const float* gradient) {
  double error = 0.0, largest = 0.0;
  for (int l = 0; l < mlp.layers(); ++l) {
    for (int bias = 0; bias < 2; ++bias) {
      const torch::Tensor g = leaves[static_cast<std::size_t>(2 * l + bias)].grad().contiguous();
      const float* ours = gradient + (bias == 1 ? mlp.bias_offset(l) : mlp.weight_offset(l));
      for (std::int64_t i = 0; i < g.numel(); ++i) {
        const double theirs = g.data_ptr<float>()[i];
        error = std::max(error, std::abs(theirs - ours[i]));
        largest = std::max(largest, std::abs(theirs));
      }
    }
  }
  EXPECT_GT(largest, 0.0);
  return error / largest;
}

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

TEST(Mlp, InitialWeightsAreOrthogonalWithTheStatedGain) {
  const Mlp mlp({20, 32, 8, 3}, HiddenActivation::kRelu);
  std::vector<float> p(mlp.parameters());
  mlp.Initialise(7, 0, 0.01F, p.data());
  const double gains[] = {std::sqrt(2.0), std::sqrt(2.0), 0.01};
  for (int l = 0; l < 3; ++l) {
    const int rows = mlp.layer_outputs(l), cols = mlp.layer_inputs(l);
    const torch::Tensor w = torch::from_blob(p.data() + mlp.weight_offset(l), {rows, cols});
    const torch::Tensor gram = rows <= cols ? w.mm(w.t()) : w.t().mm(w);
    const torch::Tensor expected = torch::eye(std::min(rows, cols)) * gains[l] * gains[l];
    EXPECT_LT((gram - expected).abs().max().item<float>(), 1e-5) << l;
    for (int i = 0; i < rows; ++i) {
      EXPECT_EQ(p[mlp.bias_offset(l) + static_cast<std::size_t>(i)], 0.0F);
    }
  }
}

/// The loss of Eqs. 41-44 in libtorch operations, by automatic differentiation.
TEST(PpoLoss, GradientIsThatOfAutomaticDifferentiation) {
  for (const auto& [activation, imitation] :
       {std::pair("tanh", 0.0F), std::pair("relu", 0.0F), std::pair("tanh", 0.3F)}) {
    TrainConfig config;
    config.activation = activation;
    config.actor_hidden = {32, 16};
    config.critic_hidden = {24};
    config.entropy = 0.01;
    config.value_weight = 0.7;
    Scenario scenario;
    const int state = 17, count = 48, agents = 4, minibatch = 96, actions = 3;
    const ActorCritic networks(scenario, state, config);
    const int features = networks.actor.inputs();
    std::vector<float> p = networks.Initialise(3, -0.7);
    // Away from the special initial point, so that no term vanishes.
    const std::vector<float> noise = Draw(p.size(), 0.1F, 4);
    for (std::size_t i = 0; i < p.size(); ++i) p[i] += noise[i];

    std::vector<float> obs = Draw(count * agents * features, 1.0F, 5);
    std::vector<float> act = Draw(count * agents * actions, 0.6F, 6);
    std::vector<float> states = Draw(count * state, 1.0F, 7);
    std::vector<float> advantages = Draw(count, 1.0F, 8), targets = Draw(count, 1.0F, 9);

    const std::vector<torch::Tensor> actor = Leaves(networks.actor, p.data());
    const std::vector<torch::Tensor> critic =
        Leaves(networks.critic, p.data() + networks.critic_offset());
    torch::Tensor log_std =
        torch::from_blob(p.data() + networks.log_std_offset(), {actions}).clone();
    log_std.requires_grad_(true);
    const torch::Tensor mean =
        networks.action_scale *
        torch::tanh(TorchForward(networks.actor, actor, View(obs, {count * agents, features})));
    const torch::Tensor z = (View(act, {count * agents, actions}) - mean) / log_std.exp();
    const torch::Tensor log_prob = (-0.5 * z * z - log_std - 0.5 * std::log(2 * M_PI)).sum(1);
    // Old probabilities around the new ones, so that both sides of the clip occur.
    std::vector<float> old = Draw(count * agents, 0.3F, 10);
    for (int r = 0; r < count * agents; ++r) {
      old[static_cast<std::size_t>(r)] += log_prob[r].item<float>();
    }
    const torch::Tensor ratio = (log_prob - View(old, {count * agents})).exp();
    const torch::Tensor a = View(advantages, {count}).repeat_interleave(agents);
    const torch::Tensor surrogate =
        torch::min(ratio * a, ratio.clamp(1 - config.clip, 1 + config.clip) * a);
    const torch::Tensor entropy = (log_std + 0.5 * std::log(2 * M_PI * M_E)).sum();
    const torch::Tensor value =
        TorchForward(networks.critic, critic, View(states, {count, state})).squeeze(1);
    const torch::Tensor value_loss = (value - View(targets, {count})).pow(2).sum() / minibatch;
    // The miss in sigmas, against the size of the teacher's action.
    std::vector<float> teacher = Draw(count * agents * actions, 0.5F, 11);
    const torch::Tensor sigma = log_std.detach().exp();
    const torch::Tensor taught = View(teacher, {count * agents, actions});
    const torch::Tensor miss =
        ((taught - mean) / sigma).pow(2).sum(1) / (1 + (taught / sigma).pow(2).sum(1)).sqrt();
    const torch::Tensor loss = -(1 - imitation) * surrogate.sum() / (minibatch * agents) +
                               imitation * 0.5 * miss.sum() / (minibatch * agents) -
                               config.entropy * entropy * count / minibatch +
                               config.value_weight * value_loss;
    loss.backward();

    PpoBatch batch;
    batch.count = count;
    batch.agents = agents;
    batch.observations = obs.data();
    batch.actions = act.data();
    batch.log_prob = old.data();
    batch.teacher = teacher.data();
    batch.imitation = imitation;
    batch.states = states.data();
    batch.advantages = advantages.data();
    batch.targets = targets.data();
    std::vector<float> gradient(networks.parameters(), 0.0F);
    const PpoSums sums = PpoLoss(networks, config, count, agents)
                             .AddGradient(p.data(), batch, minibatch, gradient.data());
    EXPECT_LT(GradientError(networks.actor, actor, gradient.data()), 1e-4)
        << activation << ", imitation " << imitation;
    EXPECT_LT(GradientError(networks.critic, critic, gradient.data() + networks.critic_offset()),
              1e-4)
        << activation;
    for (int i = 0; i < actions; ++i) {
      EXPECT_NEAR(gradient[networks.log_std_offset() + static_cast<std::size_t>(i)],
                  log_std.grad()[i].item<float>(), 1e-4);
    }
    const double clipped = ((ratio - 1).abs() > config.clip).to(torch::kFloat).sum().item<float>();
    EXPECT_GT(clipped, 0.0);
    EXPECT_EQ(sums.clipped, clipped);
    EXPECT_NEAR(sums.actor_loss, -surrogate.sum().item<float>(), 1e-2);
    EXPECT_NEAR(sums.value_loss, value_loss.item<float>() * minibatch, 1e-2);
  }
}

TEST(ActorCritic, ExportedPolicyIsTheActorAsLibtorchComputesIt) {
  TrainConfig config;
  Scenario scenario;
  const ActorCritic networks(scenario, 10, config);
  std::vector<float> p = networks.Initialise(3, -1.5);
  const std::vector<float> noise = Draw(p.size(), 0.2F, 4);
  for (std::size_t i = 0; i < p.size(); ++i) p[i] += noise[i];
  RunningMoments moments(networks.actor.inputs());
  const std::vector<float> seen =
      Draw(static_cast<std::size_t>(100 * networks.actor.inputs()), 3.0F, 5);
  moments.Add(seen.data(), 100);
  const Normaliser normaliser = Normaliser::From(moments, 0.01F, 10.0F);
  const agent::Policy policy = networks.ToPolicy(p.data(), normaliser, agent::PolicyMetadata());
  std::vector<float> obs = Draw(static_cast<std::size_t>(networks.actor.inputs()), 5.0F, 6);
  std::vector<float> normal(obs.size()), action(3);
  policy.Mean(obs.data(), action.data());
  for (std::size_t i = 0; i < obs.size(); ++i) {
    const int k = static_cast<int>(i);
    normal[i] = static_cast<float>(std::fmax(
        std::fmin((obs[i] - moments.mean(k)) / std::sqrt(moments.variance(k)), 10.0), -10.0));
  }
  const torch::Tensor mean =
      scenario.control.action_scale *
      torch::tanh(TorchForward(networks.actor, Leaves(networks.actor, p.data()),
                               View(normal, {1, networks.actor.inputs()})));
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(action[static_cast<std::size_t>(a)], mean[0][a].item<float>(), 1e-5);
  }
}

TEST(Gae, MatchesHandComputedSegmentWithTruncation) {
  // gamma = 0.5, lambda = 0.5. Step 1 ends an episode whose last state is worth 8.
  const float rewards[] = {1, 2, 3}, values[] = {10, 20, 30}, final_values[] = {-99, 8, -99};
  const std::uint8_t done[] = {0, 1, 0};
  float advantages[3];
  GeneralisedAdvantages(rewards, values, done, final_values, 40.0F, 3, 1, 0.5F, 0.5F, advantages);
  EXPECT_FLOAT_EQ(advantages[2], 3 + 0.5F * 40 - 30);                // -7
  EXPECT_FLOAT_EQ(advantages[1], 2 + 0.5F * 8 - 20);                 // -14, nothing of step 2
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
  // Far from zero, where the naive sum of squares fails in single precision.
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

TEST(WorkerPool, RunsEverySliceOnceAndPassesExceptionsOn) {
  WorkerPool pool(3);
  for (int repeat = 0; repeat < 200; ++repeat) {
    std::vector<std::atomic<int>> runs(17);
    pool.Run(17, [&](int slice, int worker) {
      EXPECT_EQ(worker, slice % 3);
      ++runs[static_cast<std::size_t>(slice)];
    });
    for (const auto& r : runs) ASSERT_EQ(r, 1);
  }
  EXPECT_THROW(pool.Run(4,
                        [](int slice, int) {
                          if (slice == 2) throw std::runtime_error("x");
                        }),
               std::runtime_error);
  int after = 0;
  pool.Run(1, [&](int, int) { ++after; });
  EXPECT_EQ(after, 1);
}

}  // namespace
}  // namespace stg::learn

#include <gtest/gtest.h>
#include <torch/nn/functional/activation.h>

#include <algorithm>
#include <cmath>

#include "learn/draw.hpp"
#include "marl_trainer/learn/algorithms/on_policy/ppo_loss.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"
#include "oracle/torch_network.hpp"

/// Compares the kernels with libtorch's automatic differentiation.
namespace stg::learn {
namespace {

torch::Tensor View(std::vector<float>& v, std::vector<std::int64_t> shape) {
  return torch::from_blob(v.data(), shape, torch::kFloat).clone();
}

TorchNetwork Reference(const Mlp& mlp, const float* parameters) {
  TorchNetwork network(mlp.spec());
  EXPECT_EQ(CountParameters(*network), mlp.parameters());
  SetParameters(parameters, network.get());
  return network;
}

/// The largest difference between a flat gradient and the one of libtorch, relative to the largest
/// component.
double GradientError(TorchNetwork network, const float* gradient) {
  std::vector<float> theirs(CountParameters(*network), 0.0F);
  AddGradients(network.get(), theirs.data());
  double error = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    const auto g = static_cast<double>(theirs[i]);
    error = std::max(error, std::abs(g - static_cast<double>(gradient[i])));
    largest = std::max(largest, std::abs(g));
  }
  EXPECT_GT(largest, 0.0);
  return error / largest;
}

NetworkSpec Spec(int inputs, std::vector<int> hidden, int outputs, HiddenActivation activation,
                 float squash) {
  NetworkSpec spec;
  spec.inputs = inputs;
  spec.hidden = std::move(hidden);
  spec.outputs = outputs;
  spec.activation = activation;
  spec.squash = squash;
  return spec;
}

TEST(BackEnds, AgreeOnOutputsAndGradientsOfEveryShape) {
  NetworkSpec normalised = Spec(20, {32, 16}, 2, HiddenActivation::kRelu, 0.0F);
  normalised.layer_norm = true;
  NetworkSpec squashed = Spec(9, {16, 24}, 3, HiddenActivation::kTanh, 0.7F);
  squashed.layer_norm = true;
  const NetworkSpec specs[] = {
      normalised,
      squashed,
      Spec(5, {}, 3, HiddenActivation::kTanh, 0.0F),
      Spec(5, {}, 3, HiddenActivation::kTanh, 0.7F),
      Spec(7, {16}, 1, HiddenActivation::kRelu, 0.0F),
      Spec(7, {16, 24, 8}, 2, HiddenActivation::kTanh, 1.5F),
      Spec(74, {64, 64}, 3, HiddenActivation::kRelu, 0.18F),
  };
  const int rows = 33;
  for (const NetworkSpec& spec : specs) {
    const Mlp mlp(spec);
    std::vector<float> p = Draw(mlp.parameters(), 0.3F, 1);
    std::vector<float> x = Draw(static_cast<std::size_t>(rows * spec.inputs), 1.0F, 2);
    std::vector<float> d = Draw(static_cast<std::size_t>(rows * spec.outputs), 1.0F, 3);
    Mlp::Workspace workspace(mlp, rows);
    mlp.Forward(p.data(), x.data(), rows, &workspace);
    std::vector<float> gradient(mlp.parameters(), 0.0F);
    mlp.Backward(p.data(), x.data(), d.data(), rows, &workspace, gradient.data());

    TorchNetwork reference = Reference(mlp, p.data());
    const torch::Tensor input = View(x, {rows, spec.inputs}).requires_grad_(true);
    const torch::Tensor y = reference->forward(input);
    (y * View(d, {rows, spec.outputs})).sum().backward();
    const torch::Tensor flat = y.detach().contiguous();
    for (int i = 0; i < rows * spec.outputs; ++i) {
      EXPECT_NEAR(workspace.output()[i], flat.data_ptr<float>()[i], 2e-5) << i;
    }
    EXPECT_LT(GradientError(reference, gradient.data()), 1e-5);
    // The gradient in all inputs, and in some in the middle.
    for (const auto& [first, count] : {std::pair(0, spec.inputs), std::pair(2, 3)}) {
      std::vector<float> d_input(static_cast<std::size_t>(rows * count));
      mlp.InputGradient(p.data(), d.data(), rows, first, count, &workspace, d_input.data());
      const double largest = input.grad().abs().max().item<double>();
      for (int r = 0; r < rows; ++r) {
        for (int i = 0; i < count; ++i) {
          EXPECT_NEAR(d_input[static_cast<std::size_t>(r * count + i)],
                      input.grad()[r][first + i].item<float>(), 1e-5 * largest);
        }
      }
    }
  }
}

TEST(BackEnds, ExchangeParameters) {
  const Mlp mlp(Spec(4, {8}, 2, HiddenActivation::kTanh, 0.0F));
  const std::vector<float> p = Draw(mlp.parameters(), 1.0F, 1);
  std::vector<float> back(p.size());
  GetParameters(*Reference(mlp, p.data()), back.data());
  EXPECT_EQ(back, p);
}

/// The loss of Eqs. 41-44, written in libtorch operations.
TEST(PpoLoss, GradientIsThatOfAutomaticDifferentiation) {
  for (const auto& [activation, imitation] :
       {std::pair(HiddenActivation::kTanh, 0.0F), std::pair(HiddenActivation::kRelu, 0.0F),
        std::pair(HiddenActivation::kTanh, 0.3F)}) {
    PpoOptions config;
    config.activation = activation;
    config.actor_hidden = {32, 16};
    config.critic_hidden = {24};
    config.entropy = 0.01;
    config.value_weight = 0.7;
    const int state = 17, count = 48, agents = 4, minibatch = 96, actions = 3, features = 74;
    Problem problem;
    problem.agents = agents;
    problem.observation_size = features;
    problem.state_size = state;
    problem.action_size = actions;
    problem.action_scale = 0.8;
    const ActorCritic networks(problem, config);
    std::vector<float> p = networks.NewActor(3, 0, -0.7).numbers;
    const std::vector<float> fresh = networks.NewCritic(3).numbers;
    const std::size_t split = p.size();
    p.insert(p.end(), fresh.begin(), fresh.end());
    // The parameters are away from the special initial point, so that no term vanishes.
    const std::vector<float> noise = Draw(p.size(), 0.1F, 4);
    for (std::size_t i = 0; i < p.size(); ++i) p[i] += noise[i];

    std::vector<float> obs = Draw(count * agents * features, 1.0F, 5);
    std::vector<float> act = Draw(count * agents * actions, 0.6F, 6);
    std::vector<float> states = Draw(count * state, 1.0F, 7);
    std::vector<float> advantages = Draw(count, 1.0F, 8), targets = Draw(count, 1.0F, 9);

    TorchNetwork actor = Reference(networks.actor.mean(), p.data());
    TorchNetwork critic = Reference(networks.critic, p.data() + split);
    torch::Tensor log_std =
        torch::from_blob(p.data() + networks.actor.log_std_offset(), {actions}).clone();
    log_std.requires_grad_(true);
    const torch::Tensor mean = actor->forward(View(obs, {count * agents, features}));
    const torch::Tensor z = (View(act, {count * agents, actions}) - mean) / log_std.exp();
    const torch::Tensor log_prob = (-0.5 * z * z - log_std - 0.5 * std::log(2 * M_PI)).sum(1);
    // Old probabilities are around the new ones, so that both sides of the clip occur.
    std::vector<float> old = Draw(count * agents, 0.3F, 10);
    for (int r = 0; r < count * agents; ++r) {
      old[static_cast<std::size_t>(r)] += log_prob[r].item<float>();
    }
    const torch::Tensor ratio = (log_prob - View(old, {count * agents})).exp();
    const torch::Tensor a = View(advantages, {count}).repeat_interleave(agents);
    const torch::Tensor surrogate =
        torch::min(ratio * a, ratio.clamp(1 - config.clip, 1 + config.clip) * a);
    const torch::Tensor entropy = (log_std + 0.5 * std::log(2 * M_PI * M_E)).sum();
    const torch::Tensor value = critic->forward(View(states, {count, state})).squeeze(1);
    const torch::Tensor value_loss = (value - View(targets, {count})).pow(2).sum() / minibatch;
    // The miss is in sigmas, and relative to the size of the teacher's action.
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
    std::vector<float> gradient(p.size(), 0.0F);
    PpoLoss kernels(networks, config, count * agents);
    PpoSums sums;
    kernels.AddActor(p.data(), batch, minibatch, gradient.data(), &sums);
    kernels.AddCritic(p.data() + split, batch, minibatch, gradient.data() + split, &sums);
    EXPECT_LT(GradientError(actor, gradient.data()), 1e-4)
        << static_cast<int>(activation) << ", imitation " << imitation;
    EXPECT_LT(GradientError(critic, gradient.data() + split), 1e-4) << static_cast<int>(activation);
    for (int i = 0; i < actions; ++i) {
      EXPECT_NEAR(gradient[networks.actor.log_std_offset() + static_cast<std::size_t>(i)],
                  log_std.grad()[i].item<float>(), 1e-4);
    }
    const double clipped = ((ratio - 1).abs() > config.clip).to(torch::kFloat).sum().item<float>();
    EXPECT_GT(clipped, 0.0);
    EXPECT_EQ(sums.clipped, clipped);
    EXPECT_NEAR(sums.actor_loss, -surrogate.sum().item<float>(), 1e-2);
    EXPECT_NEAR(sums.value_loss, value_loss.item<float>() * minibatch, 1e-2);
  }
}

TEST(GaussianActor, ExportedPolicyIsTheActorAsLibtorchComputesIt) {
  const GaussianActor actor(Spec(74, {64, 64}, 3, HiddenActivation::kTanh, 0.9F));
  std::vector<float> p(actor.parameters());
  actor.Initialise(3, 0, -1.5, p.data());
  const std::vector<float> noise = Draw(p.size(), 0.2F, 4);
  for (std::size_t i = 0; i < p.size(); ++i) p[i] += noise[i];
  RunningMoments moments(actor.inputs());
  const std::vector<float> seen = Draw(static_cast<std::size_t>(100 * actor.inputs()), 3.0F, 5);
  moments.Add(seen.data(), 100);
  const Normaliser normaliser = Normaliser::From(moments, 0.01F, 10.0F);
  const agent::Policy policy = actor.ToPolicy(p.data(), normaliser, agent::PolicyMetadata());
  std::vector<float> obs = Draw(static_cast<std::size_t>(actor.inputs()), 5.0F, 6);
  std::vector<float> normal(obs.size()), action(3);
  policy.Mean(obs.data(), action.data());
  for (std::size_t i = 0; i < obs.size(); ++i) {
    const int k = static_cast<int>(i);
    normal[i] = static_cast<float>(std::fmax(
        std::fmin((obs[i] - moments.mean(k)) / std::sqrt(moments.variance(k)), 10.0), -10.0));
  }
  const torch::Tensor mean =
      Reference(actor.mean(), p.data())->forward(View(normal, {1, actor.inputs()}));
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(action[static_cast<std::size_t>(a)], mean[0][a].item<float>(), 1e-5);
  }
  std::vector<float> back(p.size());
  actor.FromPolicy(policy, back.data());
  EXPECT_EQ(back, p);
}

}  // namespace
}  // namespace stg::learn

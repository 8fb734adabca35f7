#include "marl_trainer/learn/nn/actor_critic.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <utility>

#include "stg_agent/graph/observation.hpp"

namespace stg::learn {
namespace {

std::vector<int> Sizes(int inputs, const std::vector<int>& hidden, int outputs) {
  std::vector<int> sizes{inputs};
  sizes.insert(sizes.end(), hidden.begin(), hidden.end());
  sizes.push_back(outputs);
  return sizes;
}

HiddenActivation ActivationOf(const TrainConfig& config) {
  return config.activation == "relu" ? HiddenActivation::kRelu : HiddenActivation::kTanh;
}

}  // namespace

ActorCritic::ActorCritic(const Scenario& scenario, int state_size, const TrainConfig& config)
    : actor(Sizes(scenario.observation_size(), config.actor_hidden, scenario.action_size()),
            ActivationOf(config)),
      critic(Sizes(state_size, config.critic_hidden, 1), ActivationOf(config)),
      action_scale(static_cast<float>(scenario.control.action_scale)) {}

std::vector<float> ActorCritic::Initialise(std::uint64_t seed, double log_std) const {
  std::vector<float> p(parameters());
  actor.Initialise(seed, 0, 0.01F, p.data());
  std::fill_n(p.begin() + static_cast<std::ptrdiff_t>(log_std_offset()), action_size(),
              static_cast<float>(log_std));
  critic.Initialise(seed, 1, 1.0F, p.data() + critic_offset());
  return p;
}

void ActorCritic::PlaceWallUnits(double margin_m, double half_extent_m,
                                 const Normaliser& observations, float* parameters) const {
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int inputs = actor.layer_inputs(0), units = actor.layer_outputs(0);
  Eigen::Map<RowMajor> in(parameters + actor.weight_offset(0), units, inputs);
  Eigen::Map<Eigen::VectorXf> bias(parameters + actor.bias_offset(0), units);
  Eigen::Map<RowMajor> out(parameters + actor.weight_offset(1), actor.layer_outputs(1), units);

  const Eigen::VectorXf say =
      in.rowwise().norm().array() * out.colwise().norm().transpose().array();
  std::vector<int> order(static_cast<std::size_t>(units));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return say[a] < say[b]; });

  const int* unit = order.data();
  for (const double multiple : {0.5, 1.0, 2.0, 4.0}) {
    const double margin = multiple * margin_m / half_extent_m;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double wall : {-1.0, 1.0}) {
        // relu(1 - room / margin) of the room between target and wall, 1 - wall (own + offset).
        in.row(*unit).setZero();
        double constant = 1.0 - 1.0 / margin;
        for (const int i : {agent::kOwnPositionIndex + axis, agent::kTargetOffsetIndex + axis}) {
          const auto n = static_cast<std::size_t>(i);
          in(*unit, i) =
              static_cast<float>(wall / margin * static_cast<double>(observations.std[n]));
          constant += wall / margin * static_cast<double>(observations.mean[n]);
        }
        bias[*unit] = static_cast<float>(constant);
        out.col(*unit++).setZero();
      }
    }
  }
}

agent::Policy ActorCritic::ToPolicy(const float* parameters, const Normaliser& observations,
                                    agent::PolicyMetadata metadata) const {
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  agent::Policy::Parameters p;
  const Eigen::Index size = actor.inputs();
  p.input_mean = Eigen::Map<const Eigen::VectorXf>(observations.mean.data(), size);
  p.input_std = Eigen::Map<const Eigen::VectorXf>(observations.std.data(), size);
  p.input_clip = observations.clip;
  p.activation = actor.activation() == HiddenActivation::kRelu ? agent::Policy::Activation::kRelu
                                                               : agent::Policy::Activation::kTanh;
  for (int l = 0; l < actor.layers(); ++l) {
    agent::Policy::Layer layer;
    layer.weight = Eigen::Map<const RowMajor>(parameters + actor.weight_offset(l),
                                              actor.layer_outputs(l), actor.layer_inputs(l));
    layer.bias = Eigen::Map<const Eigen::VectorXf>(parameters + actor.bias_offset(l),
                                                   actor.layer_outputs(l));
    p.layers.push_back(std::move(layer));
  }
  p.log_std = Eigen::Map<const Eigen::VectorXf>(parameters + log_std_offset(), action_size());
  metadata.action_scale = static_cast<double>(action_scale);
  p.metadata = std::move(metadata);
  return agent::Policy(std::move(p));
}

void SquashMean(float scale, int count, float* net) {
  Eigen::Map<Eigen::ArrayXf> a(net, count);
  a = scale * a.tanh();
}

}  // namespace stg::learn

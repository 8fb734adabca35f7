#include "marl_trainer/learn/nn/gaussian_actor.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <utility>

namespace stg::learn {
namespace {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

GaussianActor::GaussianActor(NetworkSpec mean) : mean_(std::move(mean)) {
  assert(action_scale() > 0.0F);
}

void GaussianActor::Initialise(std::uint64_t seed, std::uint32_t network, double log_std,
                               float* parameters) const {
  InitialiseOrthogonally(mean_.spec(), seed, network, parameters);
  std::fill_n(parameters + log_std_offset(), action_size(), static_cast<float>(log_std));
}

agent::Policy GaussianActor::ToPolicy(const float* parameters, const Normaliser& observations,
                                      agent::PolicyMetadata metadata) const {
  agent::Policy::Parameters p;
  const Eigen::Index size = inputs();
  p.input_mean = Eigen::Map<const Eigen::VectorXf>(observations.mean.data(), size);
  p.input_std = Eigen::Map<const Eigen::VectorXf>(observations.std.data(), size);
  p.input_clip = observations.clip;
  p.activation = mean_.spec().activation == HiddenActivation::kRelu
                     ? agent::Policy::Activation::kRelu
                     : agent::Policy::Activation::kTanh;
  for (int l = 0; l < mean_.layers(); ++l) {
    agent::Policy::Layer layer;
    const int outputs = mean_.spec().layer_outputs(l);
    layer.weight = Eigen::Map<const RowMajor>(parameters + mean_.weight_offset(l), outputs,
                                              mean_.spec().layer_inputs(l));
    layer.bias = Eigen::Map<const Eigen::VectorXf>(parameters + mean_.bias_offset(l), outputs);
    p.layers.push_back(std::move(layer));
  }
  p.log_std = Eigen::Map<const Eigen::VectorXf>(parameters + log_std_offset(), action_size())
                  .cwiseMax(kNoSpread);
  metadata.action_scale = static_cast<double>(action_scale());
  p.metadata = std::move(metadata);
  return agent::Policy(std::move(p));
}

void GaussianActor::FromPolicy(const agent::Policy& policy, float* parameters) const {
  const agent::Policy::Parameters& p = policy.parameters();
  assert(p.layers.size() == static_cast<std::size_t>(mean_.layers()));
  for (int l = 0; l < mean_.layers(); ++l) {
    const agent::Policy::Layer& layer = p.layers[static_cast<std::size_t>(l)];
    assert(layer.weight.rows() == mean_.spec().layer_outputs(l));
    assert(layer.weight.cols() == mean_.spec().layer_inputs(l));
    Eigen::Map<RowMajor>(parameters + mean_.weight_offset(l), layer.weight.rows(),
                         layer.weight.cols()) = layer.weight;
    Eigen::Map<Eigen::VectorXf>(parameters + mean_.bias_offset(l), layer.bias.size()) = layer.bias;
  }
  Eigen::Map<Eigen::VectorXf>(parameters + log_std_offset(), action_size()) = p.log_std;
}

}  // namespace stg::learn

#pragma once

#include <torch/nn/module.h>
#include <torch/nn/pimpl.h>

#include <cstddef>
#include <vector>

#include "marl_trainer/learn/nn/network_spec.hpp"

/// Networks in libtorch. Its automatic differentiation tests the kernels. Only tests and a
/// benchmark need libtorch.
namespace stg::learn {

/// The network of a spec, as a module.
class TorchNetworkImpl : public torch::nn::Module {
 public:
  explicit TorchNetworkImpl(const NetworkSpec& spec);

  /// Gives [rows, outputs] for [rows, inputs].
  torch::Tensor forward(torch::Tensor x);

 private:
  const NetworkSpec spec_;
  std::vector<torch::Tensor> weights_, biases_;
};
TORCH_MODULE(TorchNetwork);

/// The parameters of any module as one flat array, in the order in which they were registered.
/// Optimiser, checkpoint and exporter work on this array with either back end. A TorchNetwork has
/// the layout of NetworkSpec, so the two back ends exchange parameters.
std::size_t CountParameters(const torch::nn::Module& module);
void SetParameters(const float* flat, torch::nn::Module* module);
void GetParameters(const torch::nn::Module& module, float* flat);
/// Adds the gradients that backward() has left, and clears them.
void AddGradients(torch::nn::Module* module, float* flat);

}  // namespace stg::learn

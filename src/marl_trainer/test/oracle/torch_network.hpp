#pragma once

#include <torch/nn/module.h>
#include <torch/nn/pimpl.h>

#include <cstddef>
#include <vector>

#include "marl_trainer/learn/nn/network_spec.hpp"

/// Networks in libtorch, whose automatic differentiation the kernels are tested against. Nothing
/// but tests and a benchmark needs libtorch.
namespace stg::learn {

/// The network that a spec describes, as a module.
class TorchNetworkImpl : public torch::nn::Module {
 public:
  explicit TorchNetworkImpl(const NetworkSpec& spec);

  /// [rows, outputs] from [rows, inputs].
  torch::Tensor forward(torch::Tensor x);

 private:
  const NetworkSpec spec_;
  std::vector<torch::Tensor> weights_, biases_;
};
TORCH_MODULE(TorchNetwork);

/// Any module's parameters as one flat array, in the order in which they were registered: what
/// optimiser, checkpoint and exporter work on, whichever back end computes. A TorchNetwork's is
/// laid out as NetworkSpec says, so the two back ends exchange parameters.
std::size_t CountParameters(const torch::nn::Module& module);
void SetParameters(const float* flat, torch::nn::Module* module);
void GetParameters(const torch::nn::Module& module, float* flat);
/// Adds the gradients that backward() left, and clears them.
void AddGradients(torch::nn::Module* module, float* flat);

}  // namespace stg::learn

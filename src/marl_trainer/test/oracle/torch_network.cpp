#include "oracle/torch_network.hpp"

#include <torch/nn/functional/linear.h>

#include <string>

namespace stg::learn {

TorchNetworkImpl::TorchNetworkImpl(const NetworkSpec& spec) : spec_(spec) {
  for (int l = 0; l < spec.layers(); ++l) {
    const std::string layer = std::to_string(l);
    weights_.push_back(register_parameter(
        "weight" + layer, torch::zeros({spec.layer_outputs(l), spec.layer_inputs(l)})));
    biases_.push_back(register_parameter("bias" + layer, torch::zeros({spec.layer_outputs(l)})));
  }
}

torch::Tensor TorchNetworkImpl::forward(torch::Tensor x) {
  for (std::size_t l = 0; l < weights_.size(); ++l) {
    x = torch::nn::functional::linear(x, weights_[l], biases_[l]);
    if (l + 1 < weights_.size() && spec_.layer_norm) {
      x = torch::layer_norm(x, {x.size(1)}, {}, {}, 1e-5);
    }
    if (l + 1 < weights_.size()) {
      x = spec_.activation == HiddenActivation::kTanh ? torch::tanh(x) : torch::relu(x);
    } else if (spec_.squash > 0.0F) {
      x = spec_.squash * torch::tanh(x);
    }
  }
  return x;
}

std::size_t CountParameters(const torch::nn::Module& module) {
  std::int64_t count = 0;
  for (const torch::Tensor& p : module.parameters()) count += p.numel();
  return static_cast<std::size_t>(count);
}

void SetParameters(const float* flat, torch::nn::Module* module) {
  const torch::NoGradGuard no_grad;
  for (torch::Tensor& p : module->parameters()) {
    // from_blob takes a pointer to writable memory. Here libtorch only reads it.
    p.copy_(torch::from_blob(const_cast<float*>(flat), p.sizes(), torch::kFloat));
    flat += p.numel();
  }
}

void GetParameters(const torch::nn::Module& module, float* flat) {
  const torch::NoGradGuard no_grad;
  for (const torch::Tensor& p : module.parameters()) {
    torch::from_blob(flat, p.sizes(), torch::kFloat).copy_(p);
    flat += p.numel();
  }
}

void AddGradients(torch::nn::Module* module, float* flat) {
  const torch::NoGradGuard no_grad;
  for (torch::Tensor& p : module->parameters()) {
    torch::from_blob(flat, p.sizes(), torch::kFloat).add_(p.grad());
    p.mutable_grad() = torch::Tensor();
    flat += p.numel();
  }
}

}  // namespace stg::learn

#pragma once

#include <torch/torch.h>

#include <vector>

#include "stg_agent/entities/pool_network.hpp"

namespace stg::learn {

inline torch::Tensor TensorOf(const float* data, at::IntArrayRef shape) {
  return torch::from_blob(const_cast<float*>(data), shape, torch::kFloat).clone();
}

/// The parameters of a network over entities as tensors of libtorch, which collect gradients.
/// @param Blocks agent::PoolBlocks or agent::GraphBlocks
template <class Blocks>
struct TorchBlocks {
  template <class Spec>
  TorchBlocks(const Spec& spec, const std::vector<float>& p) : b_(spec) {
    for (const agent::PoolBlock& block : b_.all()) {
      weights_.push_back(
          TensorOf(p.data() + block.offset, {block.rows, block.cols}).requires_grad_(true));
    }
  }
  torch::Tensor At(const agent::PoolBlock& block) const {
    const auto all = b_.all();
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all[k].offset == block.offset) return weights_[k];
    }
    return {};
  }
  torch::Tensor Dense(const torch::Tensor& x, const agent::PoolBlocks::Layer& l) const {
    return torch::addmm(At(l.bias).t(), x, At(l.weight).t());
  }

  Blocks b_;
  std::vector<torch::Tensor> weights_;
};

}  // namespace stg::learn

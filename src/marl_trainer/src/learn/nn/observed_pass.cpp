#include "marl_trainer/learn/nn/observed_pass.hpp"

namespace stg::learn {

const float* ObservedPass::Evaluate(const float* parameters, const Normaliser& scale,
                                    const float* observations, int rows) {
  if (workspace_.rows() < rows) workspace_ = Mlp::Workspace(*network_, rows);
  normalised_.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(network_->inputs()));
  scale.Apply(observations, rows, normalised_.data());
  network_->Forward(parameters, normalised_.data(), rows, &workspace_);
  return workspace_.output();
}

std::vector<ObservedPass> PassesOf(const Mlp& network, int workers) {
  return std::vector<ObservedPass>(static_cast<std::size_t>(workers), ObservedPass(network));
}

}  // namespace stg::learn

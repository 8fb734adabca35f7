#pragma once

#include <vector>

#include "marl_trainer/learn/nn/mlp.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {

/// Memory of one thread for passes of raw observations through a network. It grows with the number
/// of rows.
class ObservedPass {
 public:
  /// @param network must outlive this object.
  explicit ObservedPass(const Mlp& network) : network_(&network), workspace_(network, 0) {}

  /// Outputs [rows, outputs] for observations [rows, inputs]; valid until the next call.
  const float* Evaluate(const float* parameters, const Normaliser& scale, const float* observations,
                        int rows);

 private:
  const Mlp* network_;
  Mlp::Workspace workspace_;
  std::vector<float> normalised_;
};

/// One pass for each worker.
std::vector<ObservedPass> PassesOf(const Mlp& network, int workers);

}  // namespace stg::learn

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "auv_common/numbers/random.hpp"

namespace stg::learn {

/// Nonlinearity of the hidden layers.
enum class HiddenActivation { kTanh, kRelu };

/// Description of a multilayer perceptron, for the hand-written kernels (Mlp) and for the modules
/// of libtorch with which tests compare them.
///
/// Both keep the parameters in one flat array: for every layer the weight [outputs, inputs],
/// row-major, then the bias [outputs]. So optimisers, checkpoints and exporters do not depend on
/// which of them computes.
struct NetworkSpec {
  int inputs = 1;
  std::vector<int> hidden;  ///< widths of the hidden layers; may be empty
  HiddenActivation activation = HiddenActivation::kTanh;
  int outputs = 1;
  /// > 0: the outputs are squash * tanh of the last layer; 0: the last layer is linear.
  float squash = 0.0F;
  float output_gain = 1.0F;  ///< gain of the last layer's initial weights
  /// True: the hidden layers normalise each row before the activation (LayerNorm, Ba et al. 2016).
  /// It has no gain and offset of its own, because the next layer and the bias have the same
  /// effect.
  bool layer_norm = false;

  int layers() const { return static_cast<int>(hidden.size()) + 1; }
  int layer_inputs(int l) const;
  int layer_outputs(int l) const;
  std::size_t parameters() const;

  /// Multiply-adds of one row: forward, and forward and backward without the gradient of the input.
  double forward_products() const;
  double training_products() const;
};

/// Writes a random matrix with orthogonal rows or columns of this length (Saxe et al. 2014).
/// @param out [rows, cols], row-major, written.
void WriteOrthogonal(int rows, int cols, double gain, Random* random, float* out);

/// Writes orthogonal weights with gain sqrt(2) (ReLU) or 1 (tanh) in the hidden layers and
/// output_gain in the last layer, and zero biases.
/// @param network distinguishes the networks of one seed.
/// @param parameters [spec.parameters()], written.
void InitialiseOrthogonally(const NetworkSpec& spec, std::uint64_t seed, std::uint32_t network,
                            float* parameters);

}  // namespace stg::learn

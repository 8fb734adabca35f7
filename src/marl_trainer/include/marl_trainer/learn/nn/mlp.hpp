#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "auv_common/numbers/random.hpp"

namespace stg::learn {

/// Nonlinearity of the hidden layers.
enum class HiddenActivation { kTanh, kRelu };

/// Shape of a multilayer perceptron whose parameters lie in one flat array:
/// for every layer the weight [outputs, inputs], row-major, then the bias.
/// Hidden layers have an activation, the last one is linear.
///
/// Forward and backward are written out on flat arrays: at these sizes
/// automatic differentiation costs more than the products themselves. A test
/// holds the gradient against libtorch's.
class Mlp {
 public:
  /// @param sizes inputs, hidden widths, outputs; at least two.
  Mlp(std::vector<int> sizes, HiddenActivation activation);

  int layers() const { return static_cast<int>(sizes_.size()) - 1; }
  int inputs() const { return sizes_.front(); }
  int outputs() const { return sizes_.back(); }
  int layer_inputs(int l) const { return sizes_[static_cast<std::size_t>(l)]; }
  int layer_outputs(int l) const { return sizes_[static_cast<std::size_t>(l) + 1]; }
  HiddenActivation activation() const { return activation_; }
  std::size_t weight_offset(int l) const { return offsets_[static_cast<std::size_t>(l)]; }
  std::size_t bias_offset(int l) const;
  std::size_t parameters() const { return offsets_.back(); }

  /// Multiply-adds of one row, forward; and of one row, forward and backward
  /// without the gradient of the input.
  double forward_products() const;
  double training_products() const;

  /// Orthogonal weights with gain sqrt(2) (ReLU) or 1 (tanh) in the hidden
  /// layers and `output_gain` in the last; zero biases.
  void Initialise(std::uint64_t seed, std::uint32_t network, float output_gain,
                  float* parameters) const;

  /// Activations of up to `rows` rows; allocated once.
  class Workspace {
   public:
    Workspace(const Mlp& mlp, int rows);
    float* output() { return values_.back().data(); }
    int rows() const { return rows_; }

   private:
    friend class Mlp;
    std::vector<std::vector<float>> values_;  ///< per layer [rows, outputs]
    std::vector<float> gradient_[2];          ///< [rows, widest]
    int rows_;
  };

  /// Fills workspace->output() [rows, outputs] from x [rows, inputs].
  void Forward(const float* parameters, const float* x, int rows, Workspace* workspace) const;

  /// Adds d loss / d parameters to `gradient`, given d loss / d output
  /// [rows, outputs] of the rows that Forward saw last.
  void Backward(const float* parameters, const float* x, const float* d_output, int rows,
                Workspace* workspace, float* gradient) const;

 private:
  std::vector<int> sizes_;
  std::vector<std::size_t> offsets_;
  HiddenActivation activation_;
};

}  // namespace stg::learn

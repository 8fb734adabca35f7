#pragma once

#include <cstddef>
#include <vector>

#include "marl_trainer/learn/nn/network_spec.hpp"

namespace stg::learn {

/// Forward and backward pass of a network, written out on flat arrays, without libtorch. At these
/// sizes it is faster than libtorch (docs/adr/009). A test compares its gradient with libtorch's.
class Mlp {
 public:
  explicit Mlp(NetworkSpec spec);

  const NetworkSpec& spec() const { return spec_; }
  int layers() const { return spec_.layers(); }
  int inputs() const { return spec_.inputs; }
  int outputs() const { return spec_.outputs; }
  /// Where weight [outputs, inputs] and bias [outputs] of a layer begin in the flat array.
  std::size_t weight_offset(int l) const { return offsets_[static_cast<std::size_t>(l)]; }
  std::size_t bias_offset(int l) const;
  std::size_t parameters() const { return offsets_.back(); }

  /// Activations of up to `rows` rows, allocated once. Each thread needs its own.
  // The implicit copy constructor has a reserved name in it.
  // NOLINTNEXTLINE(bugprone-reserved-identifier)
  class Workspace {
   public:
    Workspace(const Mlp& mlp, int rows);
    float* output() { return values_.back().data(); }
    int rows() const { return rows_; }

   private:
    friend class Mlp;
    std::vector<std::vector<float>> values_;  ///< per layer [rows, outputs]
    std::vector<float> gradient_[2];          ///< [rows, widest]
    // With layer_norm, for each hidden layer: normalised values [rows, outputs] and their factors
    // [rows].
    std::vector<std::vector<float>> normalised_, inverse_std_;
    int rows_;
  };

  /// Computes workspace->output() [rows, outputs] from x [rows, inputs].
  void Forward(const float* parameters, const float* x, int rows, Workspace* workspace) const;

  /// Adds d loss / d parameters to `gradient`, from d loss / d output [rows, outputs]. The rows are
  /// the ones of the last Forward.
  void Backward(const float* parameters, const float* x, const float* d_output, int rows,
                Workspace* workspace, float* gradient) const;

  /// Writes d loss / d x[:, first .. first+count-1] to d_input [rows, count], from d loss / d
  /// output as in Backward. Computes no gradient of the parameters.
  void InputGradient(const float* parameters, const float* d_output, int rows, int first, int count,
                     Workspace* workspace, float* d_input) const;

 private:
  /// d loss / d sums of the last layer. The result is d_output itself or is in the workspace.
  const float* UndoSquash(const float* d_output, int rows, Workspace* workspace, int* next) const;
  /// d loss / d sums of layer l, from d loss / d sums of layer l + 1.
  const float* UndoLayer(const float* parameters, int l, const float* d, int rows,
                         Workspace* workspace, int* next) const;

  NetworkSpec spec_;
  std::vector<std::size_t> offsets_;
};

/// Changes the last layer of a network whose first output is a value: every output is multiplied by
/// `ratio`, and then `shift` is added to the value.
void RescaleOutputs(const Mlp& network, double ratio, double shift, float* parameters);

}  // namespace stg::learn

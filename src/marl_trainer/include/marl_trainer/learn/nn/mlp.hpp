#pragma once

#include <cstddef>
#include <vector>

#include "marl_trainer/learn/nn/network_spec.hpp"

namespace stg::learn {

/// The kernels' back end of a network: forward and backward written out on flat arrays, without
/// libtorch and at these sizes faster than it (docs/adr/009); a test holds the gradient against
/// libtorch's.
class Mlp {
 public:
  explicit Mlp(NetworkSpec spec);

  const NetworkSpec& spec() const { return spec_; }
  int layers() const { return spec_.layers(); }
  int inputs() const { return spec_.inputs; }
  int outputs() const { return spec_.outputs; }
  /// Where a layer's weight [outputs, inputs] and bias [outputs] begin in the flat array.
  std::size_t weight_offset(int l) const { return offsets_[static_cast<std::size_t>(l)]; }
  std::size_t bias_offset(int l) const;
  std::size_t parameters() const { return offsets_.back(); }

  /// Activations of up to `rows` rows; allocated once. One per thread.
  // The copy that the compiler writes has a reserved name in it.
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
    // With layer_norm, per hidden layer: what it normalised [rows, outputs], and by what [rows].
    std::vector<std::vector<float>> normalised_, inverse_std_;
    int rows_;
  };

  /// Fills workspace->output() [rows, outputs] from x [rows, inputs].
  void Forward(const float* parameters, const float* x, int rows, Workspace* workspace) const;

  /// Adds d loss / d parameters to `gradient`, given d loss / d output
  /// [rows, outputs] of the rows that Forward saw last.
  void Backward(const float* parameters, const float* x, const float* d_output, int rows,
                Workspace* workspace, float* gradient) const;

  /// Writes d loss / d x[:, first .. first+count-1] as d_input [rows, count], given d loss / d
  /// output as Backward; the parameters get no gradient.
  void InputGradient(const float* parameters, const float* d_output, int rows, int first, int count,
                     Workspace* workspace, float* d_input) const;

 private:
  /// d loss / d the last layer's sums, in the workspace unless d_output is that.
  const float* UndoSquash(const float* d_output, int rows, Workspace* workspace, int* next) const;
  /// d loss / d layer l's sums from d loss / d the sums of layer l + 1.
  const float* UndoLayer(const float* parameters, int l, const float* d, int rows,
                         Workspace* workspace, int* next) const;

  NetworkSpec spec_;
  std::vector<std::size_t> offsets_;
};

/// Changes the last layer of a network whose first output is a value, so that every output is
/// multiplied by `ratio` and the value has `shift` added.
void RescaleOutputs(const Mlp& network, double ratio, double shift, float* parameters);

}  // namespace stg::learn

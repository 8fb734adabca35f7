#include "marl_trainer/learn/nn/mlp.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "marl_trainer/learn/nn/blas.hpp"

namespace stg::learn {
namespace {

using Array = Eigen::Map<Eigen::ArrayXf>;
using ConstArray = Eigen::Map<const Eigen::ArrayXf>;

/// y = activation(y + bias), row by row.
void AddBias(const float* bias, int rows, int width, float* y) {
  const ConstArray b(bias, width);
  for (int r = 0; r < rows; ++r) Array(y + static_cast<std::ptrdiff_t>(r) * width, width) += b;
}

void Activate(HiddenActivation activation, std::ptrdiff_t count, float* y) {
  Array a(y, count);
  if (activation == HiddenActivation::kTanh) {
    a = a.tanh();
  } else {
    a = a.max(0.0F);
  }
}

/// d *= activation'(x) expressed in y = activation(x).
void ActivationGradient(HiddenActivation activation, std::ptrdiff_t count, const float* y,
                        float* d) {
  const ConstArray a(y, count);
  Array g(d, count);
  if (activation == HiddenActivation::kTanh) {
    g *= 1.0F - a * a;
  } else {
    g = (a > 0.0F).select(g, 0.0F);
  }
}

void AddColumnSums(const float* d, int rows, int width, float* sum) {
  Array s(sum, width);
  for (int r = 0; r < rows; ++r) s += ConstArray(d + static_cast<std::ptrdiff_t>(r) * width, width);
}

/// Sum of f(i) for i = 0 .. count-1. Its order depends only on `count`. The order of Eigen's sum
/// depends on the position of the numbers in memory.
template <class F>
float SumInOrder(int count, F&& f) {
  constexpr int kParts = 16;
  float parts[kParts] = {};
  int i = 0;
  for (; i + kParts <= count; i += kParts) {
    for (int k = 0; k < kParts; ++k) parts[k] += f(i + k);
  }
  for (int k = 0; i < count; ++i, ++k) parts[k] += f(i);
  for (int half = kParts / 2; half > 0; half /= 2) {
    for (int k = 0; k < half; ++k) parts[k] += parts[k + half];
  }
  return parts[0];
}

/// Normalises each row of y [rows, width] to mean 0 and variance 1. Stores a copy and the factors
/// for the backward pass.
void NormaliseRows(int rows, int width, float* y, float* copy, float* inverse_std) {
  constexpr float kSmallestVariance = 1e-5F;
  const float share = 1.0F / static_cast<float>(width);
  for (int r = 0; r < rows; ++r) {
    float* row = y + static_cast<std::ptrdiff_t>(r) * width;
    const float mean = share * SumInOrder(width, [&](int i) { return row[i]; });
    for (int i = 0; i < width; ++i) row[i] -= mean;
    const float variance = share * SumInOrder(width, [&](int i) { return row[i] * row[i]; });
    inverse_std[r] = 1.0F / std::sqrt(variance + kSmallestVariance);
    for (int i = 0; i < width; ++i) row[i] *= inverse_std[r];
  }
  std::copy_n(y, static_cast<std::ptrdiff_t>(rows) * width, copy);
}

/// Gradient by the values before the normalisation, from the gradient by its result.
void NormaliseRowsGradient(int rows, int width, const float* normalised, const float* inverse_std,
                           float* d) {
  const float share = 1.0F / static_cast<float>(width);
  for (int r = 0; r < rows; ++r) {
    const float* y = normalised + static_cast<std::ptrdiff_t>(r) * width;
    float* g = d + static_cast<std::ptrdiff_t>(r) * width;
    const float mean = share * SumInOrder(width, [&](int i) { return g[i]; });
    const float slope = share * SumInOrder(width, [&](int i) { return g[i] * y[i]; });
    for (int i = 0; i < width; ++i) g[i] = (g[i] - mean - y[i] * slope) * inverse_std[r];
  }
}

/// y = squash * tanh(y).
void Squash(float squash, std::ptrdiff_t count, float* y) {
  Array a(y, count);
  a = squash * a.tanh();
}

/// d_in = d * squash (1 - tanh^2), computed from y = squash * tanh.
void SquashGradient(float squash, std::ptrdiff_t count, const float* y, const float* d,
                    float* d_in) {
  const ConstArray a(y, count);
  Array(d_in, count) = ConstArray(d, count) * (squash - a * a / squash);
}

}  // namespace

Mlp::Mlp(NetworkSpec spec) : spec_(std::move(spec)), offsets_{0} {
  for (int l = 0; l < layers(); ++l) {
    const auto in = static_cast<std::size_t>(spec_.layer_inputs(l));
    const auto out = static_cast<std::size_t>(spec_.layer_outputs(l));
    offsets_.push_back(offsets_.back() + (in + 1) * out);
  }
}

std::size_t Mlp::bias_offset(int l) const {
  return weight_offset(l) + static_cast<std::size_t>(spec_.layer_inputs(l)) *
                                static_cast<std::size_t>(spec_.layer_outputs(l));
}

Mlp::Workspace::Workspace(const Mlp& mlp, int rows) : rows_(rows) {
  int widest = 0;
  for (int l = 0; l < mlp.layers(); ++l) {
    const int width = mlp.spec().layer_outputs(l);
    values_.emplace_back(static_cast<std::size_t>(rows) * static_cast<std::size_t>(width));
    widest = std::max(widest, width);
    if (!mlp.spec().layer_norm || l + 1 == mlp.layers()) continue;
    normalised_.emplace_back(values_.back().size());
    inverse_std_.emplace_back(static_cast<std::size_t>(rows));
  }
  for (auto& g : gradient_) {
    g.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(widest));
  }
}

void Mlp::Forward(const float* parameters, const float* x, int rows, Workspace* workspace) const {
  assert(rows <= workspace->rows_);
  for (int l = 0; l < layers(); ++l) {
    float* y = workspace->values_[static_cast<std::size_t>(l)].data();
    const int width = spec_.layer_outputs(l);
    const auto count = static_cast<std::ptrdiff_t>(rows) * width;
    Multiply(false, true, rows, width, spec_.layer_inputs(l), x, parameters + weight_offset(l),
             0.0F, y);
    AddBias(parameters + bias_offset(l), rows, width, y);
    if (l + 1 < layers() && spec_.layer_norm) {
      const auto i = static_cast<std::size_t>(l);
      NormaliseRows(rows, width, y, workspace->normalised_[i].data(),
                    workspace->inverse_std_[i].data());
    }
    if (l + 1 < layers()) Activate(spec_.activation, count, y);
    if (l + 1 == layers() && spec_.squash > 0.0F) Squash(spec_.squash, count, y);
    x = y;
  }
}

const float* Mlp::UndoSquash(const float* d_output, int rows, Workspace* workspace,
                             int* next) const {
  if (spec_.squash <= 0.0F) return d_output;
  float* d_last = workspace->gradient_[*next].data();
  SquashGradient(spec_.squash, static_cast<std::ptrdiff_t>(rows) * outputs(),
                 workspace->values_.back().data(), d_output, d_last);
  *next = 1 - *next;
  return d_last;
}

const float* Mlp::UndoLayer(const float* parameters, int l, const float* d, int rows,
                            Workspace* workspace, int* next) const {
  const auto i = static_cast<std::size_t>(l);
  const int width = spec_.layer_outputs(l);
  const float* y = workspace->values_[i].data();
  float* d_in = workspace->gradient_[*next].data();
  Multiply(false, false, rows, width, spec_.layer_outputs(l + 1), d,
           parameters + weight_offset(l + 1), 0.0F, d_in);
  ActivationGradient(spec_.activation, static_cast<std::ptrdiff_t>(rows) * width, y, d_in);
  if (spec_.layer_norm) {
    NormaliseRowsGradient(rows, width, workspace->normalised_[i].data(),
                          workspace->inverse_std_[i].data(), d_in);
  }
  *next = 1 - *next;
  return d_in;
}

void Mlp::Backward(const float* parameters, const float* x, const float* d_output, int rows,
                   Workspace* workspace, float* gradient) const {
  assert(rows <= workspace->rows_);
  int next = 0;
  const float* d = UndoSquash(d_output, rows, workspace, &next);
  for (int l = layers() - 1; l >= 0; --l) {
    const int width = spec_.layer_outputs(l), inputs = spec_.layer_inputs(l);
    const float* in = l == 0 ? x : workspace->values_[static_cast<std::size_t>(l) - 1].data();
    Multiply(true, false, width, inputs, rows, d, in, 1.0F, gradient + weight_offset(l));
    AddColumnSums(d, rows, width, gradient + bias_offset(l));
    if (l > 0) d = UndoLayer(parameters, l - 1, d, rows, workspace, &next);
  }
}

void Mlp::InputGradient(const float* parameters, const float* d_output, int rows, int first,
                        int count, Workspace* workspace, float* d_input) const {
  assert(rows <= workspace->rows_ && first >= 0 && first + count <= inputs());
  int next = 0;
  const float* d = UndoSquash(d_output, rows, workspace, &next);
  for (int l = layers() - 2; l >= 0; --l) d = UndoLayer(parameters, l, d, rows, workspace, &next);
  MultiplyColumns(rows, count, spec_.layer_outputs(0), d, parameters + weight_offset(0) + first,
                  inputs(), d_input);
}

void RescaleOutputs(const Mlp& network, double ratio, double shift, float* parameters) {
  const int last = network.layers() - 1;
  const std::size_t end = network.parameters();
  for (std::size_t i = network.weight_offset(last); i < end; ++i) {
    parameters[i] = static_cast<float>(static_cast<double>(parameters[i]) * ratio);
  }
  float& bias = parameters[network.bias_offset(last)];
  bias = static_cast<float>(static_cast<double>(bias) + shift);
}

}  // namespace stg::learn

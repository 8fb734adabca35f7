#include "marl_trainer/learn/nn/mlp.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
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

/// y = squash * tanh(y).
void Squash(float squash, std::ptrdiff_t count, float* y) {
  Array a(y, count);
  a = squash * a.tanh();
}

/// d_in = d * squash (1 - tanh^2), expressed in y = squash * tanh.
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
    if (l + 1 < layers()) Activate(spec_.activation, count, y);
    if (l + 1 == layers() && spec_.squash > 0.0F) Squash(spec_.squash, count, y);
    x = y;
  }
}

void Mlp::Backward(const float* parameters, const float* x, const float* d_output, int rows,
                   Workspace* workspace, float* gradient) const {
  assert(rows <= workspace->rows_);
  const float* d = d_output;
  int next = 0;
  if (spec_.squash > 0.0F) {
    float* d_last = workspace->gradient_[next].data();
    SquashGradient(spec_.squash, static_cast<std::ptrdiff_t>(rows) * outputs(),
                   workspace->values_.back().data(), d_output, d_last);
    d = d_last;
    next = 1 - next;
  }
  for (int l = layers() - 1; l >= 0; --l) {
    const int width = spec_.layer_outputs(l), inputs = spec_.layer_inputs(l);
    const float* in = l == 0 ? x : workspace->values_[static_cast<std::size_t>(l) - 1].data();
    Multiply(true, false, width, inputs, rows, d, in, 1.0F, gradient + weight_offset(l));
    AddColumnSums(d, rows, width, gradient + bias_offset(l));
    if (l == 0) break;
    float* d_in = workspace->gradient_[next].data();
    Multiply(false, false, rows, inputs, width, d, parameters + weight_offset(l), 0.0F, d_in);
    ActivationGradient(spec_.activation, static_cast<std::ptrdiff_t>(rows) * inputs, in, d_in);
    d = d_in;
    next = 1 - next;
  }
}

}  // namespace stg::learn

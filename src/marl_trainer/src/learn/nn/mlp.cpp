#include "marl_trainer/learn/nn/mlp.hpp"

#include <Eigen/Core>
#include <Eigen/QR>
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

}  // namespace

Mlp::Mlp(std::vector<int> sizes, HiddenActivation activation)
    : sizes_(std::move(sizes)), offsets_{0}, activation_(activation) {
  assert(sizes_.size() >= 2);
  for (int l = 0; l < layers(); ++l) {
    const auto in = static_cast<std::size_t>(layer_inputs(l));
    const auto out = static_cast<std::size_t>(layer_outputs(l));
    offsets_.push_back(offsets_.back() + (in + 1) * out);
  }
}

std::size_t Mlp::bias_offset(int l) const {
  return weight_offset(l) +
         static_cast<std::size_t>(layer_inputs(l)) * static_cast<std::size_t>(layer_outputs(l));
}

double Mlp::forward_products() const {
  double products = 0.0;
  for (int l = 0; l < layers(); ++l) products += 1.0 * layer_inputs(l) * layer_outputs(l);
  return products;
}

double Mlp::training_products() const {
  return 3.0 * forward_products() - 1.0 * layer_inputs(0) * layer_outputs(0);
}

void Mlp::Initialise(std::uint64_t seed, std::uint32_t network, float output_gain,
                     float* parameters) const {
  std::fill(parameters, parameters + this->parameters(), 0.0F);
  for (int l = 0; l < layers(); ++l) {
    Random random(seed, Stream::kInit, network, static_cast<std::uint32_t>(l), 0);
    const int rows = layer_outputs(l), cols = layer_inputs(l);
    const int large = std::max(rows, cols), small = std::min(rows, cols);
    // Q of a tall Gaussian matrix; the signs of R's diagonal make it uniform.
    Eigen::MatrixXd gaussian(large, small);
    for (int i = 0; i < large; ++i) {
      for (int j = 0; j < small; ++j) gaussian(i, j) = random.Normal();
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(gaussian);
    Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(large, small);
    for (int j = 0; j < small; ++j) {
      if (qr.matrixQR()(j, j) < 0.0) q.col(j) *= -1.0;
    }
    const double hidden_gain = activation_ == HiddenActivation::kRelu ? std::sqrt(2.0) : 1.0;
    const double gain = l + 1 == layers() ? static_cast<double>(output_gain) : hidden_gain;
    float* weight = parameters + weight_offset(l);
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < cols; ++j) {
        *weight++ = static_cast<float>(gain * (rows >= cols ? q(i, j) : q(j, i)));
      }
    }
  }
}

Mlp::Workspace::Workspace(const Mlp& mlp, int rows) : rows_(rows) {
  int widest = 0;
  for (int l = 0; l < mlp.layers(); ++l) {
    const int width = mlp.layer_outputs(l);
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
    const int width = layer_outputs(l);
    Multiply(false, true, rows, width, layer_inputs(l), x, parameters + weight_offset(l), 0.0F, y);
    AddBias(parameters + bias_offset(l), rows, width, y);
    if (l + 1 < layers()) Activate(activation_, static_cast<std::ptrdiff_t>(rows) * width, y);
    x = y;
  }
}

void Mlp::Backward(const float* parameters, const float* x, const float* d_output, int rows,
                   Workspace* workspace, float* gradient) const {
  assert(rows <= workspace->rows_);
  const float* d = d_output;
  int next = 0;
  for (int l = layers() - 1; l >= 0; --l) {
    const int width = layer_outputs(l), inputs = layer_inputs(l);
    const float* in = l == 0 ? x : workspace->values_[static_cast<std::size_t>(l) - 1].data();
    Multiply(true, false, width, inputs, rows, d, in, 1.0F, gradient + weight_offset(l));
    AddColumnSums(d, rows, width, gradient + bias_offset(l));
    if (l == 0) break;
    float* d_in = workspace->gradient_[next].data();
    Multiply(false, false, rows, inputs, width, d, parameters + weight_offset(l), 0.0F, d_in);
    ActivationGradient(activation_, static_cast<std::ptrdiff_t>(rows) * inputs, in, d_in);
    d = d_in;
    next = 1 - next;
  }
}

}  // namespace stg::learn

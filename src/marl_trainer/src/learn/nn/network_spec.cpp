#include "marl_trainer/learn/nn/network_spec.hpp"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "auv_common/numbers/random.hpp"

namespace stg::learn {

int NetworkSpec::layer_inputs(int l) const {
  return l == 0 ? inputs : hidden[static_cast<std::size_t>(l) - 1];
}

int NetworkSpec::layer_outputs(int l) const {
  return l + 1 == layers() ? outputs : hidden[static_cast<std::size_t>(l)];
}

std::size_t NetworkSpec::parameters() const {
  std::size_t count = 0;
  for (int l = 0; l < layers(); ++l) {
    count +=
        static_cast<std::size_t>(layer_inputs(l) + 1) * static_cast<std::size_t>(layer_outputs(l));
  }
  return count;
}

double NetworkSpec::forward_products() const {
  double products = 0.0;
  for (int l = 0; l < layers(); ++l) products += 1.0 * layer_inputs(l) * layer_outputs(l);
  return products;
}

double NetworkSpec::training_products() const {
  return 3.0 * forward_products() - 1.0 * layer_inputs(0) * layer_outputs(0);
}

void WriteOrthogonal(int rows, int cols, double gain, Random* random, float* out) {
  const int large = std::max(rows, cols), small = std::min(rows, cols);
  // Q of a tall Gaussian matrix. The signs of R's diagonal make its distribution uniform.
  Eigen::MatrixXd gaussian(large, small);
  for (int i = 0; i < large; ++i) {
    for (int j = 0; j < small; ++j) gaussian(i, j) = random->Normal();
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(gaussian);
  Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(large, small);
  for (int j = 0; j < small; ++j) {
    if (qr.matrixQR()(j, j) < 0.0) q.col(j) *= -1.0;
  }
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) {
      *out++ = static_cast<float>(gain * (rows >= cols ? q(i, j) : q(j, i)));
    }
  }
}

void InitialiseOrthogonally(const NetworkSpec& spec, std::uint64_t seed, std::uint32_t network,
                            float* parameters) {
  const double hidden_gain = spec.activation == HiddenActivation::kRelu ? std::sqrt(2.0) : 1.0;
  for (int l = 0; l < spec.layers(); ++l) {
    Random random(seed, Stream::kInit, network, static_cast<std::uint32_t>(l), 0);
    const int rows = spec.layer_outputs(l), cols = spec.layer_inputs(l);
    const double gain =
        l + 1 == spec.layers() ? static_cast<double>(spec.output_gain) : hidden_gain;
    WriteOrthogonal(rows, cols, gain, &random, parameters);
    parameters += static_cast<std::ptrdiff_t>(rows) * cols;
    parameters = std::fill_n(parameters, rows, 0.0F);
  }
}

}  // namespace stg::learn

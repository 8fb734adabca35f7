#include "packed_layers.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/nn/blas.hpp"
#include "marl_trainer/learn/nn/network_spec.hpp"

namespace stg::learn {

void ProductRows(const float* p, const agent::PoolBlock& weight, const float* x, int rows,
                 std::vector<float>* y) {
  y->resize(Count(rows, weight.rows));
  if (rows == 0) return;
  Multiply(false, true, rows, weight.rows, weight.cols, x, p + weight.offset, 0.0F, y->data());
}

void DenseRows(const float* p, const agent::PoolBlocks::Layer& layer, const float* x, int rows,
               bool relu, std::vector<float>* y) {
  const int outputs = layer.weight.rows;
  y->resize(Count(rows, outputs));
  if (rows == 0) return;
  const float* b = p + layer.bias.offset;
  for (int r = 0; r < rows; ++r) {
    std::copy(b, b + outputs, y->data() + static_cast<std::ptrdiff_t>(r) * outputs);
  }
  Multiply(false, true, rows, outputs, layer.weight.cols, x, p + layer.weight.offset, 1.0F,
           y->data());
  if (!relu) return;
  for (float& v : *y) v = std::max(v, 0.0F);
}

void UndoRelu(const std::vector<float>& y, std::vector<float>* d) {
  for (std::size_t i = 0; i < d->size(); ++i) {
    if (y[i] <= 0.0F) (*d)[i] = 0.0F;
  }
}

void UndoProduct(const float* p, const agent::PoolBlock& weight, const float* x, int rows,
                 const float* d, float* gradient, bool add, std::vector<float>* d_x) {
  const int outputs = weight.rows, inputs = weight.cols;
  if (d_x != nullptr) d_x->resize(Count(rows, inputs));
  if (rows == 0) return;
  Multiply(true, false, outputs, inputs, rows, d, x, 1.0F, gradient + weight.offset);
  if (d_x != nullptr) {
    Multiply(false, false, rows, inputs, outputs, d, p + weight.offset, add ? 1.0F : 0.0F,
             d_x->data());
  }
}

void UndoDense(const float* p, const agent::PoolBlocks::Layer& layer, const float* x, int rows,
               const float* d, float* gradient, std::vector<float>* d_x) {
  UndoProduct(p, layer.weight, x, rows, d, gradient, false, d_x);
  const int outputs = layer.weight.rows;
  float* b = gradient + layer.bias.offset;
  for (int r = 0; r < rows; ++r) {
    for (int k = 0; k < outputs; ++k) b[k] += d[static_cast<std::ptrdiff_t>(r) * outputs + k];
  }
}

void Initialise(const std::vector<agent::PoolBlock>& blocks,
                const std::vector<agent::PoolBlock>& outputs, double output_gain,
                std::uint64_t seed, std::uint32_t network, float* parameters) {
  std::uint32_t index = 0;
  for (const agent::PoolBlock& block : blocks) {
    std::fill(parameters + block.offset, parameters + block.offset + block.size(), 0.0F);
    ++index;
    if (block.cols <= 1) continue;
    Random random(seed, Stream::kInit, network, index, 0);
    const bool output =
        std::any_of(outputs.begin(), outputs.end(),
                    [&block](const agent::PoolBlock& o) { return o.offset == block.offset; });
    const double gain = output ? output_gain : std::sqrt(2.0);
    WriteOrthogonal(block.rows, block.cols, gain, &random, parameters + block.offset);
  }
}

}  // namespace stg::learn

#pragma once

#include <cstdint>
#include <vector>

#include "stg_agent/entities/pool_network.hpp"

/// Layers on packed rows and their gradients, written by hand.
namespace stg::learn {

inline std::size_t Count(int rows, int cols) {
  return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
}

/// Row `row` of an array with rows of `width` numbers.
inline float* RowOf(std::vector<float>* x, int row, int width) {
  return x->data() + static_cast<std::ptrdiff_t>(row) * width;
}
inline const float* RowOf(const std::vector<float>& x, int row, int width) {
  return x.data() + static_cast<std::ptrdiff_t>(row) * width;
}
/// y += factor x.
inline void AddTimes(float factor, const float* x, int count, float* y) {
  for (int k = 0; k < count; ++k) y[k] += factor * x[k];
}

/// y [rows, outputs] = x W^T.
void ProductRows(const float* p, const agent::PoolBlock& weight, const float* x, int rows,
                 std::vector<float>* y);
/// y [rows, outputs] = x W^T + b; then the rectifier if `relu`.
void DenseRows(const float* p, const agent::PoolBlocks::Layer& layer, const float* x, int rows,
               bool relu, std::vector<float>* y);

/// Sets the gradient to zero where the rectifier was zero.
void UndoRelu(const std::vector<float>& y, std::vector<float>* d);
/// Adds the gradient of a weight, from the gradient d [rows, outputs] of its products. d_x [rows,
/// inputs] may be null; it is written, or added to if `add`.
void UndoProduct(const float* p, const agent::PoolBlock& weight, const float* x, int rows,
                 const float* d, float* gradient, bool add, std::vector<float>* d_x);
/// The same for a layer; d_x is written.
void UndoDense(const float* p, const agent::PoolBlocks::Layer& layer, const float* x, int rows,
               const float* d, float* gradient, std::vector<float>* d_x);

/// Writes orthogonal weights with gain sqrt(2), or `output_gain` in the blocks `outputs`. Vectors
/// are 0.
/// @param network distinguishes the networks of one seed
void Initialise(const std::vector<agent::PoolBlock>& blocks,
                const std::vector<agent::PoolBlock>& outputs, double output_gain,
                std::uint64_t seed, std::uint32_t network, float* parameters);

}  // namespace stg::learn

#pragma once

#include <cstdint>
#include <vector>

#include "stg_agent/entities/pool_network.hpp"

/// Layers on packed rows and what flows back through them, by hand.
namespace stg::learn {

inline std::size_t Count(int rows, int cols) {
  return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
}

/// Row `row` of rows of `width` numbers.
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
/// y [rows, outputs] = x W^T + b, then relu if asked.
void DenseRows(const float* p, const agent::PoolBlocks::Layer& layer, const float* x, int rows,
               bool relu, std::vector<float>* y);

/// Where relu cut off, nothing flows back.
void UndoRelu(const std::vector<float>& y, std::vector<float>* d);
/// Adds the gradient of a weight, given d [rows, outputs] of its products. d_x may be null; it is
/// [rows, inputs], written, or added to.
void UndoProduct(const float* p, const agent::PoolBlock& weight, const float* x, int rows,
                 const float* d, float* gradient, bool add, std::vector<float>* d_x);
/// The same of a layer, whose d_x is written.
void UndoDense(const float* p, const agent::PoolBlocks::Layer& layer, const float* x, int rows,
               const float* d, float* gradient, std::vector<float>* d_x);

/// Orthogonal weights of gain sqrt(2), of `output_gain` in the blocks of `outputs`; vectors are 0.
/// @param network tells the networks of one seed apart
void Initialise(const std::vector<agent::PoolBlock>& blocks,
                const std::vector<agent::PoolBlock>& outputs, double output_gain,
                std::uint64_t seed, std::uint32_t network, float* parameters);

}  // namespace stg::learn

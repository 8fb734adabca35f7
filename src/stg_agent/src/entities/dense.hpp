#pragma once

#include <Eigen/Core>

#include "stg_agent/entities/pool_network.hpp"

/// What the networks over entities share: places of parameters, and products of one row, which
/// allocate nothing.
namespace stg::agent {

/// Gives matrices and vectors consecutive places in a flat array.
class BlockPlaces {
 public:
  PoolBlock Block(int rows, int cols) {
    const PoolBlock block{size_, rows, cols};
    size_ += block.size();
    return block;
  }
  PoolBlocks::Layer Layer(int outputs, int inputs) {
    const PoolBlock weight = Block(outputs, inputs);
    return {weight, Block(outputs, 1)};
  }
  std::size_t size() const { return size_; }

 private:
  std::size_t size_ = 0;
};

using RowMajorMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline Eigen::Map<const RowMajorMatrix> MatrixOf(const float* parameters, const PoolBlock& block) {
  return {parameters + block.offset, block.rows, block.cols};
}

/// out = W x, or out += W x if `add`.
inline void Product(const float* parameters, const PoolBlock& weight, const float* x, bool add,
                    float* out) {
  Eigen::Map<Eigen::VectorXf> y(out, weight.rows);
  if (!add) y.setZero();
  y.noalias() += MatrixOf(parameters, weight) * Eigen::Map<const Eigen::VectorXf>(x, weight.cols);
}

inline void Rectify(float* x, int count) {
  Eigen::Map<Eigen::VectorXf> y(x, count);
  y = y.cwiseMax(0.0F);
}

/// out = W x + b, then the rectifier if `relu`.
inline void Dense(const float* parameters, const PoolBlocks::Layer& layer, const float* x,
                  bool relu, float* out) {
  Eigen::Map<Eigen::VectorXf>(out, layer.weight.rows) =
      Eigen::Map<const Eigen::VectorXf>(parameters + layer.bias.offset, layer.bias.rows);
  Product(parameters, layer.weight, x, true, out);
  if (relu) Rectify(out, layer.weight.rows);
}

}  // namespace stg::agent

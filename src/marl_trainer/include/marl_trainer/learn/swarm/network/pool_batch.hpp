#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/swarm/network/packed_rows.hpp"

namespace stg::learn {

/// agent::PoolNetwork for many AUVs at once, with its gradient. It is written by hand: products of
/// packed rows and sums over segments, in an order that depends only on the rows. A test compares
/// it with libtorch.
class PoolBatch {
 public:
  explicit PoolBatch(const agent::PoolSpec& spec) : spec_(spec), blocks_(spec) {}

  const agent::PoolSpec& spec() const { return spec_; }
  const agent::PoolBlocks& blocks() const { return blocks_; }
  std::size_t parameters() const { return blocks_.size; }

  /// Memory of one thread.
  class Workspace {
   public:
    const float* output() const { return output_.data(); }

   private:
    friend class PoolBatch;
    struct Set {
      std::vector<float> first, second;  // [set rows, width]
      std::vector<int> most;  // [rows, width], the set row with the largest value; -1: none
    };
    std::vector<Set> sets_;
    std::vector<float> joined_, hidden1_, hidden2_, output_;
    std::vector<float> d_joined_, d_hidden1_, d_hidden2_, d_first_, d_second_, d_self_, self_;
  };

  /// Computes workspace->output() [rows, outputs].
  void Forward(const float* parameters, const PackedRows& x, Workspace* w) const;
  /// Adds d loss / d parameters to `gradient`, from d loss / d output [rows, outputs]. The rows are
  /// the ones of the last Forward.
  void Backward(const float* parameters, const PackedRows& x, const float* d_output, Workspace* w,
                float* gradient) const;

 private:
  agent::PoolSpec spec_;
  agent::PoolBlocks blocks_;
};

/// Writes orthogonal weights with gain sqrt(2), or `output_gain` in the head. Biases and the rows
/// that stand for empty sets are zero.
/// @param network distinguishes the networks of one seed. @param parameters [blocks.size], written
void InitialisePool(const agent::PoolBlocks& blocks, double output_gain, std::uint64_t seed,
                    std::uint32_t network, float* parameters);

}  // namespace stg::learn

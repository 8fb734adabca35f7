#pragma once

#include <cstdint>
#include <vector>

#include "stg_agent/entities/pool_network.hpp"

namespace stg::learn {

/// The rows of many AUVs, packed: the rows of a set of all AUVs in one array, with offsets (CSR).
/// An AUV without rows costs nothing.
class PackedRows {
 public:
  explicit PackedRows(const agent::PoolSpec& spec);

  void Clear();
  /// Appends one AUV. @param self, search, sets as PoolNetwork::Forward takes them
  void Add(const float* self, const float* search, const agent::PoolRows* sets);
  /// Appends AUV `row` of another store of the same sizes.
  void Add(const PackedRows& from, int row);

  int rows() const { return rows_; }
  const float* self() const { return self_.data(); }
  const float* search(int row) const {
    return search_.data() + static_cast<std::ptrdiff_t>(row) * search_size_;
  }
  /// Rows of set s, [offset(s, rows()), numbers].
  const float* set(int s) const { return sets_[static_cast<std::size_t>(s)].data(); }
  /// Where the rows of an AUV begin.
  int offset(int s, int row) const {
    return offsets_[static_cast<std::size_t>(s)][static_cast<std::size_t>(row)];
  }

 private:
  int rows_ = 0, self_size_, search_size_;
  std::vector<int> set_sizes_;
  std::vector<float> self_, search_;
  std::vector<std::vector<float>> sets_;
  std::vector<std::vector<int>> offsets_;
};

/// agent::PoolNetwork for many AUVs at once, with its gradient, written out by hand: products of
/// packed rows and sums over segments, in an order that depends on the rows alone. A test holds it
/// against libtorch.
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
      std::vector<int> most;             // [rows, width], which set row is the largest; -1: none
    };
    std::vector<Set> sets_;
    std::vector<float> joined_, hidden1_, hidden2_, output_;
    std::vector<float> d_joined_, d_hidden1_, d_hidden2_, d_first_, d_second_, d_self_, self_;
  };

  /// Fills workspace->output() [rows, outputs].
  void Forward(const float* parameters, const PackedRows& x, Workspace* w) const;
  /// Adds d loss / d parameters to `gradient`, given d loss / d output [rows, outputs] of the rows
  /// that Forward saw last.
  void Backward(const float* parameters, const PackedRows& x, const float* d_output, Workspace* w,
                float* gradient) const;

 private:
  agent::PoolSpec spec_;
  agent::PoolBlocks blocks_;
};

/// Orthogonal weights of gain sqrt(2), of `output_gain` in the head; zero biases and nobodies.
/// @param network tells the networks of one seed apart. @param parameters [blocks.size], written
void InitialisePool(const agent::PoolBlocks& blocks, double output_gain, std::uint64_t seed,
                    std::uint32_t network, float* parameters);

}  // namespace stg::learn

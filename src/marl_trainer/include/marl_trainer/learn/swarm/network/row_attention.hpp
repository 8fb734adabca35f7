#pragma once

#include <vector>

#include "stg_agent/entities/graph_network.hpp"

namespace stg::learn {

/// The rows of one set of many AUVs, as input of attention. The rows of AUV r are rows[begin(r),
/// begin(r + 1)). The row that stands for an empty set comes after them.
struct AttendedRows {
  const float* rows;    ///< [all, width]
  const float* nobody;  ///< [width], the row for an empty set
  const int* begin;     ///< [auvs + 1]
  const float* prior;   ///< [all]; each head has a weight for it; null: none
};

/// Attention with one query of each AUV to the rows of one set, with its gradient (GraphNetwork's
/// a_x).
class RowAttention {
 public:
  RowAttention(const agent::GraphBlocks::Attention& blocks, const agent::PoolBlock& prior,
               int heads)
      : blocks_(blocks), prior_(prior), heads_(heads) {}

  class Workspace {
    friend class RowAttention;
    std::vector<float> query_, key_, context_;  // [auvs, width], [heads][auvs, width] each
    std::vector<float> share_;                  // [heads][all + auvs]
    std::vector<float> part_, d_query_, d_key_, d_context_;
  };

  /// @param self [auvs, hidden] @param out rows of `stride` numbers; the first `width` are written
  void Forward(const float* p, int auvs, const float* self, const AttendedRows& x, int stride,
               float* out, Workspace* w) const;
  /// Adds to `gradient`, d_rows [all, width], d_nobody [width] and d_self [auvs, hidden].
  /// @param d_out has the layout of `out`
  void Backward(const float* p, int auvs, const float* self, const AttendedRows& x, int stride,
                const float* d_out, Workspace* w, float* gradient, float* d_rows, float* d_nobody,
                std::vector<float>* d_self) const;

 private:
  int width() const { return blocks_.key.rows; }
  float scale() const;
  void Weigh(const float* p, int head, int auvs, const AttendedRows& x, Workspace* w) const;
  void UndoWeigh(int head, int auvs, const AttendedRows& x, Workspace* w, float* gradient,
                 float* d_rows, float* d_nobody) const;

  agent::GraphBlocks::Attention blocks_;
  agent::PoolBlock prior_;
  int heads_;
};

}  // namespace stg::learn

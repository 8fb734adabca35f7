#pragma once

#include <vector>

#include "stg_agent/entities/graph_network.hpp"
#include "stg_agent/entities/pool_network.hpp"

namespace stg::learn {

/// Sizes of the rows that a network over entities takes.
struct RowSizes {
  explicit RowSizes(const agent::PoolSpec& spec)
      : self(spec.self), search(spec.search), sets(spec.sets) {}
  explicit RowSizes(const agent::GraphSpec& spec)
      : self(spec.self),
        search(spec.search),
        sets{spec.targets, spec.neighbours, spec.obstacles},
        edges(spec.edges) {}

  int self, search;
  std::vector<int> sets;
  /// Size of an edge between a row of set 0 and a row of set 1; 0: there are no edges.
  int edges = 0;
};

/// The rows of many AUVs, packed: for each set, the rows of all AUVs in one array with offsets
/// (CSR). An AUV without rows costs nothing. The edges of an AUV are [rows of set 0, rows of set
/// 1].
class PackedRows {
 public:
  explicit PackedRows(RowSizes sizes);

  void Clear();
  /// Appends one AUV.
  void Add(const agent::GraphRows& rows);
  /// The same without edges. @param self, search, sets as in PoolNetwork::Forward
  void Add(const float* self, const float* search, const agent::PoolRows* sets);
  /// Appends AUV `row` of another object with the same sizes.
  void Add(const PackedRows& from, int row);

  int rows() const { return rows_; }
  const float* self() const { return self_.data(); }
  const float* search(int row) const {
    return search_.data() + static_cast<std::ptrdiff_t>(row) * sizes_.search;
  }
  /// Rows of set s, [offset(s, rows()), numbers].
  const float* set(int s) const { return sets_[static_cast<std::size_t>(s)].data(); }
  /// Where the rows of an AUV begin in set s.
  int offset(int s, int row) const {
    return offsets_[static_cast<std::size_t>(s)][static_cast<std::size_t>(row)];
  }
  const int* offsets(int s) const { return offsets_[static_cast<std::size_t>(s)].data(); }
  /// Edges of all AUVs, [edge_offset(rows()), numbers], and where the edges of an AUV begin.
  const float* edges() const { return edges_.data(); }
  int edge_offset(int row) const { return edge_offsets_[static_cast<std::size_t>(row)]; }

 private:
  int rows_ = 0;
  RowSizes sizes_;
  std::vector<float> self_, search_, edges_;
  std::vector<std::vector<float>> sets_;
  std::vector<std::vector<int>> offsets_;
  std::vector<int> edge_offsets_;
};

}  // namespace stg::learn

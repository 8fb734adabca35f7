#include "marl_trainer/learn/swarm/network/packed_rows.hpp"

#include <utility>

namespace stg::learn {

PackedRows::PackedRows(RowSizes sizes)
    : sizes_(std::move(sizes)), sets_(sizes_.sets.size()), offsets_(sizes_.sets.size()) {
  Clear();
}

void PackedRows::Clear() {
  rows_ = 0;
  self_.clear();
  search_.clear();
  edges_.clear();
  for (auto& s : sets_) s.clear();
  for (auto& o : offsets_) o.assign(1, 0);
  edge_offsets_.assign(1, 0);
}

void PackedRows::Add(const float* self, const float* search, const agent::PoolRows* sets) {
  self_.insert(self_.end(), self, self + sizes_.self);
  search_.insert(search_.end(), search, search + sizes_.search);
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    for (int r = 0; r < sets[s].count; ++r) {
      const float* row = sets[s].rows + static_cast<std::ptrdiff_t>(r) * sets[s].stride;
      sets_[s].insert(sets_[s].end(), row, row + sizes_.sets[s]);
    }
    offsets_[s].push_back(offsets_[s].back() + sets[s].count);
  }
  edge_offsets_.push_back(edge_offsets_.back());
  ++rows_;
}

void PackedRows::Add(const agent::GraphRows& rows) {
  Add(rows.self, rows.search, rows.sets);
  if (sizes_.edges == 0) return;
  for (int t = 0; t < rows.sets[0].count; ++t) {
    for (int j = 0; j < rows.sets[1].count; ++j) {
      const float* edge = rows.edges + static_cast<std::ptrdiff_t>(t) * rows.edge_target_stride +
                          static_cast<std::ptrdiff_t>(j) * rows.edge_stride;
      edges_.insert(edges_.end(), edge, edge + sizes_.edges);
    }
  }
  edge_offsets_.back() += rows.sets[0].count * rows.sets[1].count;
}

void PackedRows::Add(const PackedRows& from, int row) {
  agent::PoolRows sets[agent::PoolNetwork::kMaxSets];
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    const int begin = from.offset(static_cast<int>(s), row), size = sizes_.sets[s];
    sets[s] = {from.set(static_cast<int>(s)) + static_cast<std::ptrdiff_t>(begin) * size,
               from.offset(static_cast<int>(s), row + 1) - begin, size};
  }
  Add(from.self() + static_cast<std::ptrdiff_t>(row) * sizes_.self, from.search(row), sets);
  const float* edges = from.edges();
  edges_.insert(edges_.end(),
                edges + static_cast<std::ptrdiff_t>(from.edge_offset(row)) * sizes_.edges,
                edges + static_cast<std::ptrdiff_t>(from.edge_offset(row + 1)) * sizes_.edges);
  edge_offsets_.back() += from.edge_offset(row + 1) - from.edge_offset(row);
}

}  // namespace stg::learn

#include "marl_trainer/learn/swarm/network/graph_batch.hpp"

#include <algorithm>

#include "packed_layers.hpp"

namespace stg::learn {
GraphBatch::GraphBatch(const agent::GraphSpec& spec)
    : spec_(spec),
      blocks_(spec_),
      attention_{RowAttention(blocks_.attention[0], blocks_.prior, spec.heads),
                 RowAttention(blocks_.attention[1], blocks_.prior, spec.heads),
                 RowAttention(blocks_.attention[2], blocks_.prior, spec.heads)} {}

AttendedRows GraphBatch::Attended(int s, const float* p, const PackedRows& x,
                                  const Workspace& w) const {
  const auto k = static_cast<std::size_t>(s);
  return {s == 0 ? w.targets_.data() : w.sets_[k].second.data(), p + blocks_.sets[k].nobody.offset,
          x.offsets(s), s == 1 ? w.prior_.data() : nullptr};
}

/// Computes the messages. For target t of AUV r they are the messages of its neighbours, then the
/// one of the empty set, from row edge_offset(r) + offset(0, r) + t (neighbours + 1) on.
void GraphBatch::PassMessages(const float* p, const PackedRows& x, Workspace* w) const {
  const int rows = x.rows(), width = spec_.width;
  const int targets = x.offset(0, rows), neighbours = x.offset(1, rows);
  ProductRows(p, blocks_.edge_neighbour, w->sets_[1].second.data(), neighbours, &w->from_);
  DenseRows(p, blocks_.edge_target, w->sets_[0].second.data(), targets, false, &w->base_);
  ProductRows(p, blocks_.edge_row, x.edges(), x.edge_offset(rows), &w->edge_);
  w->message_.resize(Count(x.edge_offset(rows) + targets, width));
  w->heard_.assign(Count(targets, 3 * width), 0.0F);
  w->heard_most_.assign(Count(targets, width), -1);
  const float* nobody = p + blocks_.edge_nobody.offset;
  float* m = w->message_.data();
  int message = 0;
  for (int r = 0; r < rows; ++r) {
    const int first = x.offset(1, r), count = x.offset(1, r + 1) - first;
    const float share = 1.0F / static_cast<float>(count + 1);
    const float* edge = RowOf(w->edge_, x.edge_offset(r), width);
    for (int t = x.offset(0, r); t < x.offset(0, r + 1); ++t) {
      const float* base = RowOf(w->base_, t, width);
      float* heard = RowOf(&w->heard_, t, 3 * width);
      float *mean = heard + width, *most = mean + width;
      int* which = w->heard_most_.data() + Count(t, width);
      const float* own = RowOf(w->sets_[0].second, t, width);
      std::copy(own, own + width, heard);
      for (int j = 0; j <= count; ++j, m += width, ++message) {
        const float* from = j < count ? RowOf(w->from_, first + j, width) : nobody;
        for (int k = 0; k < width; ++k) {
          float sum = base[k] + from[k];
          if (j < count) sum += edge[k];
          m[k] = std::max(sum, 0.0F);
          mean[k] += share * m[k];
          if (m[k] > most[k]) {
            most[k] = m[k];
            which[k] = message;
          }
        }
        if (j < count) edge += width;
      }
    }
  }
  DenseRows(p, blocks_.update, w->heard_.data(), targets, true, &w->targets_);
}

void GraphBatch::Join(const float* p, const PackedRows& x, Workspace* w) const {
  const int rows = x.rows(), width = spec_.width, joined = spec_.joined();
  const int neighbours = x.offset(1, rows);
  w->prior_.resize(static_cast<std::size_t>(neighbours));
  for (int j = 0; j < neighbours; ++j) {
    w->prior_[static_cast<std::size_t>(j)] = agent::GraphPrior(
        x.set(1)[Count(j, spec_.neighbours) + static_cast<std::size_t>(spec_.quality)]);
  }
  DenseRows(p, blocks_.self, x.self(), rows, true, &w->self_);
  w->joined_.resize(Count(rows, joined));
  for (int r = 0; r < rows; ++r) {
    const float* self = RowOf(w->self_, r, spec_.hidden);
    float* to = std::copy(self, self + spec_.hidden, RowOf(&w->joined_, r, joined));
    std::copy(x.search(r), x.search(r) + spec_.search, to);
  }
  const int attended = spec_.hidden + spec_.search;
  for (int s = 0; s < 3; ++s) {
    const auto k = static_cast<std::size_t>(s);
    attention_[k].Forward(p, rows, w->self_.data(), Attended(s, p, x, *w), joined,
                          w->joined_.data() + attended + s * width, &w->attention_[k]);
  }
  for (int s = 0; s < 2; ++s) {
    const AttendedRows all = Attended(s, p, x, *w);
    std::vector<int>& which = s == 0 ? w->target_most_ : w->neighbour_most_;
    which.assign(Count(rows, width), -1);
    for (int r = 0; r < rows; ++r) {
      float* most = RowOf(&w->joined_, r, joined) + attended + (3 + s) * width;
      int* at = which.data() + Count(r, width);
      std::copy(all.nobody, all.nobody + width, most);
      for (int m = all.begin[r]; m < all.begin[r + 1]; ++m) {
        const float* h = all.rows + static_cast<std::ptrdiff_t>(m) * width;
        for (int k = 0; k < width; ++k) {
          if (h[k] > most[k]) {
            most[k] = h[k];
            at[k] = m;
          }
        }
      }
    }
  }
}

void GraphBatch::Choose(const float* p, const PackedRows& x, Workspace* w) const {
  const int rows = x.rows(), width = spec_.width, outputs = spec_.outputs;
  const int targets = x.offset(0, rows);
  ProductRows(p, blocks_.pointer, w->hidden2_.data(), rows, &w->pointed_);
  DenseRows(p, blocks_.head, w->hidden2_.data(), rows, false, &w->sums_);
  w->choices_.resize(static_cast<std::size_t>(targets + rows));
  w->output_.resize(Count(targets + rows, outputs));
  const AttendedRows all = Attended(0, p, x, *w);
  const float* W = p + blocks_.head_row.offset;
  int choice = 0;
  for (int r = 0; r < rows; ++r) {
    const float *at = RowOf(w->pointed_, r, width), *sums = RowOf(w->sums_, r, outputs);
    for (int m = all.begin[r]; m <= all.begin[r + 1]; ++m, ++choice) {
      const bool target = m < all.begin[r + 1];
      const float* h = target ? all.rows + static_cast<std::ptrdiff_t>(m) * width : all.nobody;
      float logit = 0.0F;
      for (int k = 0; k < width; ++k) logit += at[k] * h[k];
      if (target) {
        logit += p[blocks_.follow.offset] *
                 x.set(0)[Count(m, spec_.targets) + static_cast<std::size_t>(spec_.follows)];
      }
      w->choices_[static_cast<std::size_t>(choice)] = logit;
      float* out = RowOf(&w->output_, choice, outputs);
      for (int k = 0; k < outputs; ++k) {
        out[k] = sums[k];
        for (int c = 0; c < width; ++c) out[k] += W[k * width + c] * h[c];
      }
    }
  }
}

void GraphBatch::Forward(const float* p, const PackedRows& x, Workspace* w) const {
  for (int s = 0; s < 3; ++s) {
    Workspace::Set& own = w->sets_[static_cast<std::size_t>(s)];
    const agent::PoolBlocks::Set& set = blocks_.sets[static_cast<std::size_t>(s)];
    const int all = x.offset(s, x.rows());
    DenseRows(p, set.first, x.set(s), all, true, &own.first);
    DenseRows(p, set.second, own.first.data(), all, true, &own.second);
  }
  PassMessages(p, x, w);
  Join(p, x, w);
  DenseRows(p, blocks_.trunk1, w->joined_.data(), x.rows(), true, &w->hidden1_);
  DenseRows(p, blocks_.trunk2, w->hidden1_.data(), x.rows(), true, &w->hidden2_);
  Choose(p, x, w);
}

void InitialiseGraph(const agent::GraphBlocks& blocks, double output_gain, std::uint64_t seed,
                     std::uint32_t network, float* parameters) {
  constexpr float kQuality = 1.0F, kFollowed = 4.0F;
  Initialise(blocks.all(), {blocks.head.weight, blocks.head_row, blocks.pointer}, output_gain, seed,
             network, parameters);
  std::fill_n(parameters + blocks.prior.offset, blocks.prior.size(), kQuality);
  parameters[blocks.follow.offset] = kFollowed;
}

}  // namespace stg::learn

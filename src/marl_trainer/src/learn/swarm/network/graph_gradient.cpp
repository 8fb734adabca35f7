#include <algorithm>

#include "marl_trainer/learn/swarm/network/graph_batch.hpp"
#include "packed_layers.hpp"

/// The backward pass of GraphBatch.
namespace stg::learn {
void GraphBatch::UndoChoose(const float* p, const PackedRows& x, const float* d_choices,
                            const float* d_output, Workspace* w, float* gradient) const {
  const int rows = x.rows(), width = spec_.width, outputs = spec_.outputs;
  const AttendedRows all = Attended(0, p, x, *w);
  w->d_pointed_.assign(Count(rows, width), 0.0F);
  w->d_sums_.assign(Count(rows, outputs), 0.0F);
  const float* W = p + blocks_.head_row.offset;
  float* d_W = gradient + blocks_.head_row.offset;
  float* d_nobody = gradient + blocks_.sets[0].nobody.offset;
  int choice = 0;
  for (int r = 0; r < rows; ++r) {
    const float* at = RowOf(w->pointed_, r, width);
    for (int m = all.begin[r]; m <= all.begin[r + 1]; ++m, ++choice) {
      const bool target = m < all.begin[r + 1];
      const float* h = target ? all.rows + static_cast<std::ptrdiff_t>(m) * width : all.nobody;
      float* d_h = target ? RowOf(&w->d_targets_, m, width) : d_nobody;
      const float d = d_choices[choice];
      AddTimes(d, at, width, d_h);
      AddTimes(d, h, width, RowOf(&w->d_pointed_, r, width));
      if (target) {
        gradient[blocks_.follow.offset] +=
            d * x.set(0)[Count(m, spec_.targets) + static_cast<std::size_t>(spec_.follows)];
      }
      const float* d_out = d_output + static_cast<std::ptrdiff_t>(choice) * outputs;
      AddTimes(1.0F, d_out, outputs, RowOf(&w->d_sums_, r, outputs));
      for (int k = 0; k < outputs; ++k) {
        if (d_out[k] == 0.0F) continue;  // only a chosen output has a gradient
        AddTimes(d_out[k], W + static_cast<std::ptrdiff_t>(k) * width, width, d_h);
        AddTimes(d_out[k], h, width, d_W + static_cast<std::ptrdiff_t>(k) * width);
      }
    }
  }
  UndoDense(p, blocks_.head, w->hidden2_.data(), rows, w->d_sums_.data(), gradient, &w->d_hidden2_);
  UndoProduct(p, blocks_.pointer, w->hidden2_.data(), rows, w->d_pointed_.data(), gradient, true,
              &w->d_hidden2_);
}

void GraphBatch::UndoJoin(const float* p, const PackedRows& x, Workspace* w,
                          float* gradient) const {
  const int rows = x.rows(), width = spec_.width, joined = spec_.joined();
  const int attended = spec_.hidden + spec_.search;
  w->d_self_.resize(Count(rows, spec_.hidden));
  for (int r = 0; r < rows; ++r) {
    const float* row = RowOf(w->d_joined_, r, joined);
    std::copy(row, row + spec_.hidden, RowOf(&w->d_self_, r, spec_.hidden));
  }
  for (int s = 0; s < 3; ++s) {
    const auto k = static_cast<std::size_t>(s);
    float* d_rows = s == 0 ? w->d_targets_.data() : w->sets_[k].d_second.data();
    float* d_nobody = gradient + blocks_.sets[k].nobody.offset;
    attention_[k].Backward(p, rows, w->self_.data(), Attended(s, p, x, *w), joined,
                           w->d_joined_.data() + attended + s * width, &w->attention_[k], gradient,
                           d_rows, d_nobody, &w->d_self_);
    if (s == 2) continue;
    const std::vector<int>& which = s == 0 ? w->target_most_ : w->neighbour_most_;
    for (int r = 0; r < rows; ++r) {
      const float* d_most = RowOf(w->d_joined_, r, joined) + attended + (3 + s) * width;
      const int* at = which.data() + Count(r, width);
      for (int c = 0; c < width; ++c) {
        (at[c] < 0 ? d_nobody : d_rows + static_cast<std::ptrdiff_t>(at[c]) * width)[c] +=
            d_most[c];
      }
    }
  }
  UndoRelu(w->self_, &w->d_self_);
  UndoDense(p, blocks_.self, x.self(), rows, w->d_self_.data(), gradient, nullptr);
}

void GraphBatch::UndoMessages(const float* p, const PackedRows& x, Workspace* w,
                              float* gradient) const {
  const int rows = x.rows(), width = spec_.width;
  const int targets = x.offset(0, rows), neighbours = x.offset(1, rows);
  UndoRelu(w->targets_, &w->d_targets_);
  UndoDense(p, blocks_.update, w->heard_.data(), targets, w->d_targets_.data(), gradient,
            &w->d_heard_);
  w->d_from_.assign(Count(neighbours, width), 0.0F);
  w->d_base_.assign(Count(targets, width), 0.0F);
  w->d_edge_.assign(Count(x.edge_offset(rows), width), 0.0F);
  float* d_nobody = gradient + blocks_.edge_nobody.offset;
  int message = 0;
  for (int r = 0; r < rows; ++r) {
    const int first = x.offset(1, r), count = x.offset(1, r + 1) - first;
    const float share = 1.0F / static_cast<float>(count + 1);
    int edge = x.edge_offset(r);
    for (int t = x.offset(0, r); t < x.offset(0, r + 1); ++t) {
      const float* d_heard = RowOf(w->d_heard_, t, 3 * width);
      const float *d_mean = d_heard + width, *d_most = d_mean + width;
      const int* which = w->heard_most_.data() + Count(t, width);
      AddTimes(1.0F, d_heard, width, RowOf(&w->sets_[0].d_second, t, width));
      float* d_base = RowOf(&w->d_base_, t, width);
      for (int j = 0; j <= count; ++j, ++message) {
        const float* m = RowOf(w->message_, message, width);
        float* d_from = j < count ? RowOf(&w->d_from_, first + j, width) : d_nobody;
        float* d_edge = j < count ? RowOf(&w->d_edge_, edge++, width) : nullptr;
        for (int k = 0; k < width; ++k) {
          if (m[k] <= 0.0F) continue;
          const float d = share * d_mean[k] + (which[k] == message ? d_most[k] : 0.0F);
          d_base[k] += d;
          d_from[k] += d;
          if (d_edge != nullptr) d_edge[k] = d;
        }
      }
    }
  }
  UndoProduct(p, blocks_.edge_row, x.edges(), x.edge_offset(rows), w->d_edge_.data(), gradient,
              false, nullptr);
  UndoProduct(p, blocks_.edge_neighbour, w->sets_[1].second.data(), neighbours, w->d_from_.data(),
              gradient, true, &w->sets_[1].d_second);
  // The same as UndoDense, but the result is added.
  UndoProduct(p, blocks_.edge_target.weight, w->sets_[0].second.data(), targets, w->d_base_.data(),
              gradient, true, &w->sets_[0].d_second);
  float* d_bias = gradient + blocks_.edge_target.bias.offset;
  for (int t = 0; t < targets; ++t) AddTimes(1.0F, RowOf(w->d_base_, t, width), width, d_bias);
}

void GraphBatch::Backward(const float* p, const PackedRows& x, const float* d_choices,
                          const float* d_output, Workspace* w, float* gradient) const {
  const int rows = x.rows(), width = spec_.width;
  w->d_targets_.assign(Count(x.offset(0, rows), width), 0.0F);
  for (int s = 0; s < 3; ++s) {
    w->sets_[static_cast<std::size_t>(s)].d_second.assign(Count(x.offset(s, rows), width), 0.0F);
  }
  UndoChoose(p, x, d_choices, d_output, w, gradient);
  UndoRelu(w->hidden2_, &w->d_hidden2_);
  UndoDense(p, blocks_.trunk2, w->hidden1_.data(), rows, w->d_hidden2_.data(), gradient,
            &w->d_hidden1_);
  UndoRelu(w->hidden1_, &w->d_hidden1_);
  UndoDense(p, blocks_.trunk1, w->joined_.data(), rows, w->d_hidden1_.data(), gradient,
            &w->d_joined_);
  UndoJoin(p, x, w, gradient);
  UndoMessages(p, x, w, gradient);
  for (int s = 0; s < 3; ++s) {
    Workspace::Set& own = w->sets_[static_cast<std::size_t>(s)];
    const agent::PoolBlocks::Set& set = blocks_.sets[static_cast<std::size_t>(s)];
    const int all = x.offset(s, rows);
    UndoRelu(own.second, &own.d_second);
    UndoDense(p, set.second, own.first.data(), all, own.d_second.data(), gradient, &own.d_first);
    UndoRelu(own.first, &own.d_first);
    UndoDense(p, set.first, x.set(s), all, own.d_first.data(), gradient, nullptr);
  }
}

}  // namespace stg::learn

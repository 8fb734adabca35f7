#include "marl_trainer/learn/swarm/network/pool_batch.hpp"

#include <algorithm>

#include "packed_layers.hpp"

namespace stg::learn {

void PoolBatch::Forward(const float* p, const PackedRows& x, Workspace* w) const {
  const int rows = x.rows(), width = spec_.width, joined = spec_.joined();
  w->sets_.resize(spec_.sets.size());
  w->joined_.assign(Count(rows, joined), 0.0F);
  DenseRows(p, blocks_.self, x.self(), rows, true, &w->self_);
  for (int r = 0; r < rows; ++r) {
    float* row = w->joined_.data() + static_cast<std::ptrdiff_t>(r) * joined;
    const float* self = w->self_.data() + static_cast<std::ptrdiff_t>(r) * spec_.hidden;
    std::copy(self, self + spec_.hidden, row);
    std::copy(x.search(r), x.search(r) + spec_.search, row + spec_.hidden);
  }
  for (int s = 0; s < spec_.sets_count(); ++s) {
    const agent::PoolBlocks::Set& set = blocks_.sets[static_cast<std::size_t>(s)];
    Workspace::Set& own = w->sets_[static_cast<std::size_t>(s)];
    const int all = x.offset(s, rows);
    DenseRows(p, set.first, x.set(s), all, true, &own.first);
    DenseRows(p, set.second, own.first.data(), all, true, &own.second);
    own.most.resize(Count(rows, width));
    const float* nobody = p + set.nobody.offset;
    for (int r = 0; r < rows; ++r) {
      float* mean = w->joined_.data() + static_cast<std::ptrdiff_t>(r) * joined + spec_.hidden +
                    spec_.search + 2 * width * s;
      float* most = mean + width;
      int* which = own.most.data() + static_cast<std::ptrdiff_t>(r) * width;
      std::copy(nobody, nobody + width, mean);
      std::copy(nobody, nobody + width, most);
      std::fill(which, which + width, -1);
      const int begin = x.offset(s, r), end = x.offset(s, r + 1);
      for (int m = begin; m < end; ++m) {
        const float* h = own.second.data() + static_cast<std::ptrdiff_t>(m) * width;
        for (int k = 0; k < width; ++k) {
          mean[k] += h[k];
          if (h[k] > most[k]) {
            most[k] = h[k];
            which[k] = m;
          }
        }
      }
      const float share = 1.0F / static_cast<float>(end - begin + 1);
      for (int k = 0; k < width; ++k) mean[k] *= share;
    }
  }
  DenseRows(p, blocks_.trunk1, w->joined_.data(), rows, true, &w->hidden1_);
  DenseRows(p, blocks_.trunk2, w->hidden1_.data(), rows, true, &w->hidden2_);
  DenseRows(p, blocks_.head, w->hidden2_.data(), rows, false, &w->output_);
}

void PoolBatch::Backward(const float* p, const PackedRows& x, const float* d_output, Workspace* w,
                         float* gradient) const {
  const int rows = x.rows(), width = spec_.width, joined = spec_.joined();
  UndoDense(p, blocks_.head, w->hidden2_.data(), rows, d_output, gradient, &w->d_hidden2_);
  UndoRelu(w->hidden2_, &w->d_hidden2_);
  UndoDense(p, blocks_.trunk2, w->hidden1_.data(), rows, w->d_hidden2_.data(), gradient,
            &w->d_hidden1_);
  UndoRelu(w->hidden1_, &w->d_hidden1_);
  UndoDense(p, blocks_.trunk1, w->joined_.data(), rows, w->d_hidden1_.data(), gradient,
            &w->d_joined_);
  w->d_self_.resize(Count(rows, spec_.hidden));
  for (int r = 0; r < rows; ++r) {
    const float* row = w->d_joined_.data() + static_cast<std::ptrdiff_t>(r) * joined;
    std::copy(row, row + spec_.hidden,
              w->d_self_.data() + static_cast<std::ptrdiff_t>(r) * spec_.hidden);
  }
  UndoRelu(w->self_, &w->d_self_);
  UndoDense(p, blocks_.self, x.self(), rows, w->d_self_.data(), gradient, nullptr);
  for (int s = 0; s < spec_.sets_count(); ++s) {
    const agent::PoolBlocks::Set& set = blocks_.sets[static_cast<std::size_t>(s)];
    Workspace::Set& own = w->sets_[static_cast<std::size_t>(s)];
    const int all = x.offset(s, rows);
    w->d_second_.assign(Count(all, width), 0.0F);
    float* d_nobody = gradient + set.nobody.offset;
    for (int r = 0; r < rows; ++r) {
      const float* d_mean = w->d_joined_.data() + static_cast<std::ptrdiff_t>(r) * joined +
                            spec_.hidden + spec_.search + 2 * width * s;
      const float* d_most = d_mean + width;
      const int* which = own.most.data() + static_cast<std::ptrdiff_t>(r) * width;
      const int begin = x.offset(s, r), end = x.offset(s, r + 1);
      const float share = 1.0F / static_cast<float>(end - begin + 1);
      for (int m = begin; m < end; ++m) {
        float* d = w->d_second_.data() + static_cast<std::ptrdiff_t>(m) * width;
        for (int k = 0; k < width; ++k) d[k] += d_mean[k] * share;
      }
      for (int k = 0; k < width; ++k) {
        d_nobody[k] += d_mean[k] * share;
        if (which[k] < 0) {
          d_nobody[k] += d_most[k];
        } else {
          w->d_second_[Count(which[k], width) + static_cast<std::size_t>(k)] += d_most[k];
        }
      }
    }
    UndoRelu(own.second, &w->d_second_);
    UndoDense(p, set.second, own.first.data(), all, w->d_second_.data(), gradient, &w->d_first_);
    UndoRelu(own.first, &w->d_first_);
    UndoDense(p, set.first, x.set(s), all, w->d_first_.data(), gradient, nullptr);
  }
}

void InitialisePool(const agent::PoolBlocks& blocks, double output_gain, std::uint64_t seed,
                    std::uint32_t network, float* parameters) {
  Initialise(blocks.all(), {blocks.head.weight}, output_gain, seed, network, parameters);
}

}  // namespace stg::learn

#include "marl_trainer/learn/swarm/pool_batch.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/nn/blas.hpp"

namespace stg::learn {
namespace {

std::size_t Count(int rows, int cols) {
  return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
}

/// y [rows, outputs] = x W^T + b, then relu if asked.
void DenseRows(const float* p, const agent::PoolBlocks::Layer& layer, const float* x, int rows,
               bool relu, std::vector<float>* y) {
  const int outputs = layer.weight.rows;
  y->resize(Count(rows, outputs));
  if (rows == 0) return;
  const float* b = p + layer.bias.offset;
  for (int r = 0; r < rows; ++r) {
    std::copy(b, b + outputs, y->data() + static_cast<std::ptrdiff_t>(r) * outputs);
  }
  Multiply(false, true, rows, outputs, layer.weight.cols, x, p + layer.weight.offset, 1.0F,
           y->data());
  if (!relu) return;
  for (float& v : *y) v = std::max(v, 0.0F);
}

/// Where relu cut off, nothing flows back.
void UndoRelu(const std::vector<float>& y, std::vector<float>* d) {
  for (std::size_t i = 0; i < d->size(); ++i) {
    if (y[i] <= 0.0F) (*d)[i] = 0.0F;
  }
}

/// Adds the gradients of a layer, given d [rows, outputs] of its sums; d_x may be null.
void UndoDense(const float* p, const agent::PoolBlocks::Layer& layer, const float* x, int rows,
               const float* d, float* gradient, std::vector<float>* d_x) {
  const int outputs = layer.weight.rows, inputs = layer.weight.cols;
  if (d_x != nullptr) d_x->resize(Count(rows, inputs));
  if (rows == 0) return;
  Multiply(true, false, outputs, inputs, rows, d, x, 1.0F, gradient + layer.weight.offset);
  float* b = gradient + layer.bias.offset;
  for (int r = 0; r < rows; ++r) {
    for (int k = 0; k < outputs; ++k) b[k] += d[static_cast<std::ptrdiff_t>(r) * outputs + k];
  }
  if (d_x != nullptr) {
    Multiply(false, false, rows, inputs, outputs, d, p + layer.weight.offset, 0.0F, d_x->data());
  }
}

}  // namespace

PackedRows::PackedRows(const agent::PoolSpec& spec)
    : self_size_(spec.self),
      search_size_(spec.search),
      set_sizes_(spec.sets),
      sets_(spec.sets.size()),
      offsets_(spec.sets.size()) {
  Clear();
}

void PackedRows::Clear() {
  rows_ = 0;
  self_.clear();
  search_.clear();
  for (auto& s : sets_) s.clear();
  for (auto& o : offsets_) o.assign(1, 0);
}

void PackedRows::Add(const float* self, const float* search, const agent::PoolRows* sets) {
  self_.insert(self_.end(), self, self + self_size_);
  search_.insert(search_.end(), search, search + search_size_);
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    for (int r = 0; r < sets[s].count; ++r) {
      const float* row = sets[s].rows + static_cast<std::ptrdiff_t>(r) * sets[s].stride;
      sets_[s].insert(sets_[s].end(), row, row + set_sizes_[s]);
    }
    offsets_[s].push_back(offsets_[s].back() + sets[s].count);
  }
  ++rows_;
}

void PackedRows::Add(const PackedRows& from, int row) {
  agent::PoolRows sets[agent::PoolNetwork::kMaxSets];
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    const int begin = from.offset(static_cast<int>(s), row);
    sets[s] = {from.set(static_cast<int>(s)) + static_cast<std::ptrdiff_t>(begin) * set_sizes_[s],
               from.offset(static_cast<int>(s), row + 1) - begin, set_sizes_[s]};
  }
  Add(from.self() + static_cast<std::ptrdiff_t>(row) * self_size_, from.search(row), sets);
}

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
  std::fill(parameters, parameters + blocks.size, 0.0F);
  std::uint32_t index = 0;
  for (const agent::PoolBlock& block : blocks.all()) {
    ++index;
    if (block.cols <= 1) continue;
    Random random(seed, Stream::kInit, network, index, 0);
    const int large = std::max(block.rows, block.cols), small = std::min(block.rows, block.cols);
    Eigen::MatrixXd gaussian(large, small);
    for (int i = 0; i < large; ++i) {
      for (int j = 0; j < small; ++j) gaussian(i, j) = random.Normal();
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(gaussian);
    Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(large, small);
    for (int j = 0; j < small; ++j) {
      if (qr.matrixQR()(j, j) < 0.0) q.col(j) *= -1.0;
    }
    const double gain = block.offset == blocks.head.weight.offset ? output_gain : std::sqrt(2.0);
    float* out = parameters + block.offset;
    for (int i = 0; i < block.rows; ++i) {
      for (int j = 0; j < block.cols; ++j) {
        *out++ = static_cast<float>(gain * (block.rows >= block.cols ? q(i, j) : q(j, i)));
      }
    }
  }
}

}  // namespace stg::learn

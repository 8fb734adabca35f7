#include "marl_trainer/learn/swarm/network/row_attention.hpp"

#include <algorithm>
#include <cmath>

#include "marl_trainer/learn/nn/blas.hpp"
#include "packed_layers.hpp"

namespace stg::learn {
namespace {

/// Copies columns [first, first + count) of rows of `stride` numbers, without gaps.
void TakeColumns(const float* from, int rows, int stride, int first, int count,
                 std::vector<float>* to) {
  to->resize(Count(rows, count));
  for (int r = 0; r < rows; ++r) {
    const float* row = from + static_cast<std::ptrdiff_t>(r) * stride + first;
    std::copy(row, row + count, to->data() + static_cast<std::ptrdiff_t>(r) * count);
  }
}

void PutColumns(const std::vector<float>& from, int rows, int stride, int first, int count,
                float* to) {
  for (int r = 0; r < rows; ++r) {
    const float* row = from.data() + static_cast<std::ptrdiff_t>(r) * count;
    std::copy(row, row + count, to + static_cast<std::ptrdiff_t>(r) * stride + first);
  }
}

float InnerProduct(const float* a, const float* b, int count) {
  float sum = 0.0F;
  for (int k = 0; k < count; ++k) sum += a[k] * b[k];
  return sum;
}

}  // namespace

float RowAttention::scale() const {
  return 1.0F / std::sqrt(static_cast<float>(width()) / static_cast<float>(heads_));
}

void RowAttention::Weigh(const float* p, int head, int auvs, const AttendedRows& x,
                         Workspace* w) const {
  const int n = width(), all = x.begin[auvs];
  const float* u = w->key_.data() + Count(head * auvs, n);
  float* context = w->context_.data() + Count(head * auvs, n);
  float* share = w->share_.data() + Count(head, all + auvs);
  const float weight = p[prior_.offset + static_cast<std::size_t>(head)];
  std::fill(context, context + Count(auvs, n), 0.0F);
  for (int r = 0; r < auvs; ++r, u += n, context += n) {
    const int begin = x.begin[r], count = x.begin[r + 1] - begin;
    const auto row = [&](int k) {
      return k < count ? x.rows + static_cast<std::ptrdiff_t>(begin + k) * n : x.nobody;
    };
    float most = -3e38F, sum = 0.0F;
    for (int k = 0; k <= count; ++k) {
      share[k] = InnerProduct(u, row(k), n) * scale();
      if (x.prior != nullptr && k < count) share[k] += weight * x.prior[begin + k];
      most = std::max(most, share[k]);
    }
    for (int k = 0; k <= count; ++k) sum += share[k] = std::exp(share[k] - most);
    for (int k = 0; k <= count; ++k) {
      share[k] /= sum;
      AddTimes(share[k], row(k), n, context);
    }
    share += count + 1;
  }
}

void RowAttention::Forward(const float* p, int auvs, const float* self, const AttendedRows& x,
                           int stride, float* out, Workspace* w) const {
  const int n = width(), size = n / heads_;
  ProductRows(p, blocks_.query, self, auvs, &w->query_);
  w->key_.resize(Count(heads_ * auvs, n));
  w->context_.resize(Count(heads_ * auvs, n));
  w->share_.resize(Count(heads_, x.begin[auvs] + auvs));
  for (int h = 0; h < heads_; ++h) {
    const std::size_t at = Count(h * size, n), mine = Count(h * auvs, n);
    TakeColumns(w->query_.data(), auvs, n, h * size, size, &w->part_);
    if (auvs > 0) {
      Multiply(false, false, auvs, n, size, w->part_.data(), p + blocks_.key.offset + at, 0.0F,
               w->key_.data() + mine);
    }
    Weigh(p, h, auvs, x, w);
    if (auvs > 0) {
      Multiply(false, true, auvs, size, n, w->context_.data() + mine, p + blocks_.value.offset + at,
               0.0F, w->part_.data());
    }
    PutColumns(w->part_, auvs, stride, h * size, size, out);
  }
}

void RowAttention::UndoWeigh(int head, int auvs, const AttendedRows& x, Workspace* w,
                             float* gradient, float* d_rows, float* d_nobody) const {
  const int n = width(), all = x.begin[auvs];
  const float* u = w->key_.data() + Count(head * auvs, n);
  const float* share = w->share_.data() + Count(head, all + auvs);
  const float* d_context = w->d_context_.data();
  w->d_key_.assign(Count(auvs, n), 0.0F);
  float* d_u = w->d_key_.data();
  float* d_weight = gradient + prior_.offset + head;
  for (int r = 0; r < auvs; ++r, u += n, d_u += n, d_context += n) {
    const int begin = x.begin[r], count = x.begin[r + 1] - begin;
    const auto row = [&](int k) {
      return k < count ? x.rows + static_cast<std::ptrdiff_t>(begin + k) * n : x.nobody;
    };
    float mean = 0.0F;  // mean of the gradients of the shares
    for (int k = 0; k <= count; ++k) mean += share[k] * InnerProduct(d_context, row(k), n);
    for (int k = 0; k <= count; ++k) {
      const float d_score = share[k] * (InnerProduct(d_context, row(k), n) - mean);
      float* d_row = k < count ? d_rows + static_cast<std::ptrdiff_t>(begin + k) * n : d_nobody;
      AddTimes(share[k], d_context, n, d_row);
      AddTimes(d_score * scale(), u, n, d_row);
      AddTimes(d_score * scale(), row(k), n, d_u);
      if (x.prior != nullptr && k < count) *d_weight += d_score * x.prior[begin + k];
    }
    share += count + 1;
  }
}

void RowAttention::Backward(const float* p, int auvs, const float* self, const AttendedRows& x,
                            int stride, const float* d_out, Workspace* w, float* gradient,
                            float* d_rows, float* d_nobody, std::vector<float>* d_self) const {
  const int n = width(), size = n / heads_;
  if (auvs == 0) return;
  w->d_query_.resize(Count(auvs, n));
  w->d_context_.resize(Count(auvs, n));
  for (int h = 0; h < heads_; ++h) {
    const std::size_t at = Count(h * size, n), mine = Count(h * auvs, n);
    const float* K = p + blocks_.key.offset + at;
    const float* V = p + blocks_.value.offset + at;
    TakeColumns(d_out, auvs, stride, h * size, size, &w->part_);
    Multiply(true, false, size, n, auvs, w->part_.data(), w->context_.data() + mine, 1.0F,
             gradient + blocks_.value.offset + at);
    Multiply(false, false, auvs, n, size, w->part_.data(), V, 0.0F, w->d_context_.data());
    UndoWeigh(h, auvs, x, w, gradient, d_rows, d_nobody);
    TakeColumns(w->query_.data(), auvs, n, h * size, size, &w->part_);
    Multiply(true, false, size, n, auvs, w->part_.data(), w->d_key_.data(), 1.0F,
             gradient + blocks_.key.offset + at);
    Multiply(false, true, auvs, size, n, w->d_key_.data(), K, 0.0F, w->part_.data());
    PutColumns(w->part_, auvs, n, h * size, size, w->d_query_.data());
  }
  UndoProduct(p, blocks_.query, self, auvs, w->d_query_.data(), gradient, true, d_self);
}

}  // namespace stg::learn

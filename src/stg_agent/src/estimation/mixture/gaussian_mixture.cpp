#include "gaussian_mixture.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

namespace stg::agent {
namespace {

constexpr double kLeastWeight = 1e-6;
/// Measurements cannot distinguish two components that are closer than this: their squared distance
/// in units of their mean covariance of the position, times the smaller share of their weight.
constexpr double kTooClose = 0.1;
/// Components that are farther apart than this are not merged, however small their weight is.
constexpr double kFar = 9.0;
/// A normal distribution split into three: weights, offset in standard deviations, kept share of
/// the variance. The offset is the best fit in L2 (DeMars, Bishop, Jah 2013). With the kept
/// variance, the split has the same variance as the original.
constexpr double kOuterWeight = 0.2252246249;
constexpr double kOffset = 1.0575154615;
constexpr double kKept = 1.0 - 2.0 * kOuterWeight * kOffset * kOffset;

double* Allocate(std::size_t numbers) {
  return static_cast<double*>(::operator new(numbers * sizeof(double), kAlignment));
}

}  // namespace

GaussianMixture::GaussianMixture(int least, int most, int capacity)
    : least_(least), most_(most), capacity_(capacity) {
  assert(least <= most);
  Resize(most);
  data_.reset(Allocate(step_ * static_cast<std::size_t>(capacity)));
  Resize(least);
}

GaussianMixture::GaussianMixture(const GaussianMixture& other)
    : GaussianMixture(other.least_, other.most_, other.capacity_) {
  *this = other;
}

GaussianMixture& GaussianMixture::operator=(const GaussianMixture& other) {
  assert(most_ == other.most_ && other.size_ <= capacity_);
  if (this == &other) return *this;
  size_ = other.size_;
  Resize(other.states_);
  std::copy_n(other.data_.get(), static_cast<std::size_t>(size_) * step_, data_.get());
  return *this;
}

void GaussianMixture::Resize(int states) {
  states_ = states;
  stride_ = (states + kRegister - 1) / kRegister * kRegister;
  step_ = static_cast<std::size_t>(kRegister + stride_ + stride_ * stride_);
}

void GaussianMixture::Cover(int states) {
  assert(states <= most_);
  if (states <= states_) return;
  const int before = stride_;
  const std::size_t step = step_;
  Resize(states);
  if (stride_ == before) return;
  const auto widen = [&](const double* from, double* to) {
    std::memmove(to, from, static_cast<std::size_t>(before) * sizeof(double));
    std::fill(to + before, to + stride_, 0.0);
  };
  // Every number moves back, so the last one moves first.
  for (int k = size_ - 1; k >= 0; --k) {
    const double* from = data_.get() + static_cast<std::size_t>(k) * step;
    const Gaussian to = at(k);
    std::fill(to.P + before * stride_, to.P + stride_ * stride_, 0.0);
    for (int r = before - 1; r >= 0; --r) {
      widen(from + kRegister + before + r * before, to.P + r * stride_);
    }
    widen(from + kRegister, to.x);
    *to.weight = *from;
  }
}

Gaussian GaussianMixture::Add() {
  assert(!full());
  const Gaussian g = at(size_++);
  std::fill_n(g.weight, step_, 0.0);
  *g.weight = 1.0;
  return g;
}

Gaussian GaussianMixture::Copy(int k) {
  assert(!full());
  const Gaussian from = at(k), to = at(size_++);
  std::copy_n(from.weight, step_, to.weight);
  return to;
}

void GaussianMixture::AddPart(const GaussianMixture& other, int k) {
  assert(states_ <= other.states_);
  const Gaussian from = other.at(k), to = Add();
  *to.weight = *from.weight;
  std::copy_n(from.x, states_, to.x);
  for (int r = 0; r < states_; ++r) {
    std::copy_n(from.P + r * other.stride_, states_, to.P + r * stride_);
  }
}

void GaussianMixture::Remove(int k) {
  --size_;
  if (k < size_) std::copy_n(at(size_).weight, step_, at(k).weight);
}

void GaussianMixture::Normalise() {
  double sum = 0.0;
  for (int k = 0; k < size_; ++k) sum += *at(k).weight;
  // If all are impossible, they get equal weights.
  const bool none = !(sum > 0.0) || !std::isfinite(sum);
  for (int k = 0; k < size_; ++k) *at(k).weight = none ? 1.0 / size_ : *at(k).weight / sum;
}

void GaussianMixture::Split(int k, const double* Pa, double variance) {
  assert(size_ + 2 <= capacity_);
  const double scale = 1.0 / std::sqrt(variance);
  const Gaussian middle = at(k), left = at(size_), right = at(size_ + 1);
  size_ += 2;
  for (int r = 0; r < stride_; ++r) {
    const double f = (1.0 - kKept) * scale * scale * Pa[r], offset = kOffset * scale * Pa[r];
    left.x[r] = middle.x[r] - offset;
    right.x[r] = middle.x[r] + offset;
    double *row = middle.P + r * stride_, *row_l = left.P + r * stride_,
           *row_r = right.P + r * stride_;
    for (int c = 0; c < stride_; ++c) row_l[c] = row_r[c] = row[c] -= f * Pa[c];
  }
  *left.weight = *right.weight = *middle.weight * kOuterWeight;
  *middle.weight *= 1.0 - 2.0 * kOuterWeight;
}

double GaussianMixture::Separation(int i, int j) const {
  const Gaussian a = at(i), b = at(j);
  const int s = stride_;
  const auto sum = [&](int r, int c) {
    return (*a.weight * a.P[r * s + c] + *b.weight * b.P[r * s + c]) / (*a.weight + *b.weight);
  };
  const double xx = sum(0, 0), xy = sum(0, 1), xz = sum(0, 2), yy = sum(1, 1), yz = sum(1, 2),
               zz = sum(2, 2);
  const double dx = a.x[0] - b.x[0], dy = a.x[1] - b.x[1], dz = a.x[2] - b.x[2];
  // Solves by elimination.
  const double l1 = xy / xx, l2 = xz / xx;
  const double y2 = yy - l1 * xy, yz2 = yz - l1 * xz;
  const double l3 = yz2 / y2, z2 = zz - l2 * xz - l3 * yz2;
  const double ey = dy - l1 * dx, ez = dz - l2 * dx - l3 * ey;
  const double distance = dx * dx / xx + ey * ey / y2 + ez * ez / z2;
  const double share = std::min(*a.weight, *b.weight) / (*a.weight + *b.weight);
  return std::max(distance * share, distance > kFar ? 2.0 * kTooClose : 0.0);
}

void GaussianMixture::Merge(int into, int from) {
  const Gaussian a = at(into), b = at(from);
  const double sum = *a.weight + *b.weight, wa = *a.weight / sum, wb = *b.weight / sum;
  const double spread = wa * wb;
  for (int r = 0; r < states_; ++r) {
    const double f = spread * (a.x[r] - b.x[r]);
    double* into_row = a.P + r * stride_;
    const double* from_row = b.P + r * stride_;
    for (int c = 0; c < stride_; ++c) {  // beyond the states are zeros
      into_row[c] = wa * into_row[c] + wb * from_row[c] + f * (a.x[c] - b.x[c]);
    }
  }
  for (int r = 0; r < states_; ++r) a.x[r] = wa * a.x[r] + wb * b.x[r];
  *a.weight = sum;
  Remove(from);
}

void GaussianMixture::Reduce(int most) {
  if (size_ <= 1) return;
  for (int k = size_ - 1; k >= 0 && size_ > 1; --k) {
    if (*at(k).weight < kLeastWeight) Remove(k);
  }
  Normalise();
  for (int i = 0; i < size_; ++i) {
    for (int j = size_ - 1; j > i; --j) {
      if (Separation(i, j) < kTooClose) Merge(i, j);
    }
  }
  while (size_ > most) MergeNearest();
}

void GaussianMixture::MergeNearest() {
  int a = 0, b = 1;
  double least = Separation(0, 1);
  for (int i = 0; i < size_; ++i) {
    for (int j = i + 1; j < size_; ++j) {
      const double s = Separation(i, j);
      if (s >= least) continue;
      least = s;
      a = i;
      b = j;
    }
  }
  Merge(a, b);
}

}  // namespace stg::agent

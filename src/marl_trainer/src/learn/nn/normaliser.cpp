#include "marl_trainer/learn/nn/normaliser.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "auv_common/error.hpp"

namespace stg::learn {

RunningMoments::RunningMoments(int size)
    : mean_(static_cast<std::size_t>(size), 0.0),
      squares_(static_cast<std::size_t>(size), 0.0),
      scratch_(2 * static_cast<std::size_t>(size), 0.0) {}

void RunningMoments::Add(const float* x, int rows) {
  if (rows == 0) return;
  const std::size_t n = mean_.size();
  double* mean = scratch_.data();
  double* squares = mean + n;
  std::fill(scratch_.begin(), scratch_.end(), 0.0);
  // Two passes, because the batch is in the cache and the variance loses no digits.
  for (int r = 0; r < rows; ++r) {
    const float* row = x + static_cast<std::size_t>(r) * n;
    for (std::size_t i = 0; i < n; ++i) mean[i] += static_cast<double>(row[i]);
  }
  for (std::size_t i = 0; i < n; ++i) mean[i] /= rows;
  for (int r = 0; r < rows; ++r) {
    const float* row = x + static_cast<std::size_t>(r) * n;
    for (std::size_t i = 0; i < n; ++i) {
      const double d = static_cast<double>(row[i]) - mean[i];
      squares[i] += d * d;
    }
  }
  const double total = count_ + rows;
  for (std::size_t i = 0; i < n; ++i) {
    const double delta = mean[i] - mean_[i];
    mean_[i] += delta * rows / total;
    squares_[i] += squares[i] + delta * delta * count_ * rows / total;
  }
  count_ = total;
}

void RunningMoments::Merge(const RunningMoments& other) {
  assert(other.size() == size());
  if (other.count_ == 0.0) return;
  const double total = count_ + other.count_;
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const double delta = other.mean_[i] - mean_[i];
    mean_[i] += delta * other.count_ / total;
    squares_[i] += other.squares_[i] + delta * delta * count_ * other.count_ / total;
  }
  count_ = total;
}

void RunningMoments::LimitCount(double limit) {
  if (count_ <= limit) return;
  for (double& s : squares_) s *= limit / count_;
  count_ = limit;
}

void RunningMoments::Clear() {
  count_ = 0.0;
  std::fill(mean_.begin(), mean_.end(), 0.0);
  std::fill(squares_.begin(), squares_.end(), 0.0);
}

double RunningMoments::variance(int i) const {
  return count_ > 0.0 ? squares_[static_cast<std::size_t>(i)] / count_ : 1.0;
}

std::vector<double> RunningMoments::Save() const {
  std::vector<double> data{count_};
  data.insert(data.end(), mean_.begin(), mean_.end());
  data.insert(data.end(), squares_.begin(), squares_.end());
  return data;
}

void RunningMoments::Load(const std::vector<double>& data) {
  const std::size_t n = mean_.size();
  assert(data.size() == 1 + 2 * n);
  const auto squares = data.begin() + 1 + static_cast<std::ptrdiff_t>(n);
  if (data[0] < 0.0 || std::any_of(squares, data.end(), [](double x) { return x < 0.0; })) {
    throw UserError("moments with a negative count or square");
  }
  count_ = data[0];
  std::copy_n(data.begin() + 1, n, mean_.begin());
  std::copy_n(squares, n, squares_.begin());
}

Normaliser Normaliser::From(const RunningMoments& moments, float floor, float clip) {
  Normaliser normaliser;
  normaliser.clip = clip;
  for (int i = 0; i < moments.size(); ++i) {
    normaliser.mean.push_back(static_cast<float>(moments.mean(i)));
    normaliser.std.push_back(std::max(static_cast<float>(std::sqrt(moments.variance(i))), floor));
  }
  return normaliser;
}

void Normaliser::Apply(const float* x, int rows, float* y) const {
  const std::size_t n = mean.size();
  const float* m = mean.data();
  const float* s = std.data();
  for (int r = 0; r < rows; ++r, x += n, y += n) {
    for (std::size_t i = 0; i < n; ++i) {
      y[i] = std::min(std::max((x[i] - m[i]) / s[i], -clip), clip);
    }
  }
}

}  // namespace stg::learn

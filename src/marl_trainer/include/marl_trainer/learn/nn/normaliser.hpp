#pragma once

#include <cstddef>
#include <vector>

namespace stg::learn {

/// Running mean and variance of vectors: count, mean and sum of squared deviations per component.
/// Parts can be merged in any grouping (Chan et al. 1979).
class RunningMoments {
 public:
  explicit RunningMoments(int size = 0);

  /// Adds `rows` vectors x [rows, size].
  void Add(const float* x, int rows);
  void Merge(const RunningMoments& other);
  /// Limits the count, so that old data loses weight smoothly.
  void LimitCount(double limit);
  void Clear();

  int size() const { return static_cast<int>(mean_.size()); }
  double count() const { return count_; }
  double mean(int i) const { return mean_[static_cast<std::size_t>(i)]; }
  /// Population variance; 1 without data.
  double variance(int i) const;

  /// Plain data for checkpoints: count, means, squared deviations.
  std::vector<double> Save() const;
  /// Throws UserError if a count or a square is negative.
  void Load(const std::vector<double>& data);

 private:
  double count_ = 0.0;
  std::vector<double> mean_, squares_;
  std::vector<double> scratch_;
};

/// A fixed affine map: y = clip((x - mean) / std, +-clip).
struct Normaliser {
  std::vector<float> mean, std;
  float clip = 10.0F;

  /// std = max(sqrt(variance), floor). The floor avoids very large values when a component changes
  /// for the first time.
  static Normaliser From(const RunningMoments& moments, float floor, float clip);
  /// Computes y [rows, size] from x [rows, size]; x == y is allowed.
  void Apply(const float* x, int rows, float* y) const;
};

}  // namespace stg::learn

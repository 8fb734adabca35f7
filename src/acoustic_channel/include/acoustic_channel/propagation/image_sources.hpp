#pragma once

#include <cmath>

namespace stg::acoustics {

/// One path between two nodes in a layer with flat boundaries.
struct ImagePath {
  double length_m;
  double sin_theta;     ///< of the grazing angle at both boundaries, >= 0
  int surface, bottom;  ///< reflections
};

/// Calls f(const ImagePath&) for the first `count` paths: the straight one, the surface's image,
/// the bottom's, then both, by ascending number of reflections (images of a layer: Jensen et al.,
/// Computational Ocean Acoustics, 2011, Eq. 2.139). Swapping the two depths changes nothing, bit
/// for bit.
/// @param range_m horizontal @param depth_a_m, depth_b_m within [0, layer_m], down
template <class F>
void ForEachImage(double range_m, double depth_a_m, double depth_b_m, double layer_m, int count,
                  F&& f) {
  const double difference = std::abs(depth_a_m - depth_b_m);
  const double sum = depth_a_m + depth_b_m;
  int left = count;
  const auto emit = [&](double rise, int surface, int bottom) {
    if (left-- <= 0) return;
    const double length = std::sqrt(range_m * range_m + rise * rise);
    f(ImagePath{length, length > 0.0 ? rise / length : 0.0, surface, bottom});
  };
  emit(difference, 0, 0);
  for (int n = 0; 1 + 4 * n < count; ++n) {
    const double down = 2.0 * layer_m * n, next = down + 2.0 * layer_m;
    emit(down + sum, n + 1, n);
    emit(next - sum, n, n + 1);
    // The wave that starts upwards and the one that starts downwards.
    emit(next - difference, n + 1, n + 1);
    emit(next + difference, n + 1, n + 1);
  }
}

}  // namespace stg::acoustics

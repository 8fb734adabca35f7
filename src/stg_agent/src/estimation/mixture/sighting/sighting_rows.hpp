#pragma once

#include <algorithm>
#include <array>

#include "sighting_model.hpp"

/// Parts of the equations of SightingModel.
namespace stg::agent {

/// The line from the observer to the target and its covariance, including errors of the observer.
struct SightingModel::Geometry {
  Vec3<double> d;       ///< target minus observer
  double C[3][3];       ///< covariance of d
  double range, level;  ///< length, and length of its horizontal part

  double Along(const Vec3<double>& a, const Vec3<double>& b) const {
    const double u[3] = {a.x, a.y, a.z}, v[3] = {b.x, b.y, b.z};
    double sum = 0.0;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) sum += u[r] * C[r][c] * v[c];
    }
    return sum;
  }
  double Along(const Vec3<double>& a) const { return Along(a, a); }
};

/// The nonzero numbers of a row.
struct SightingModel::Row {
  std::array<int, 6> index{};
  std::array<double, 6> value{};
  int count = 0;

  void Add(int i, double v) {
    index[static_cast<std::size_t>(count)] = i;
    value[static_cast<std::size_t>(count++)] = v;
  }
  /// Computes P times the row as a column. Returns row P column.
  double Times(const Gaussian& g, int stride, double* column) const {
    std::fill_n(column, stride, 0.0);
    for (int k = 0; k < count; ++k) {
      const double v = value[static_cast<std::size_t>(k)];
      const double* p = g.P + index[static_cast<std::size_t>(k)] * stride;
      for (int c = 0; c < stride; ++c) column[c] += v * p[c];
    }
    return Dot(column);
  }
  double Dot(const double* column) const {
    double sum = 0.0;
    for (int k = 0; k < count; ++k) {
      sum += value[static_cast<std::size_t>(k)] * column[index[static_cast<std::size_t>(k)]];
    }
    return sum;
  }
};

/// One number of a detection, linearised at a component.
struct SightingModel::Form {
  Row row;
  double innovation = 0.0;
  double variance = 0.0;  ///< of the noise and of the second order
  double alike = 0.0;     ///< part of the second order that many measurements share
};

/// The point that a detection measures, relative to the observer.
struct SightingModel::Point {
  Vec3<double> axes[3];  ///< of its noise
  double variance[3];    ///< along them
  Vec3<double> r;
};

}  // namespace stg::agent

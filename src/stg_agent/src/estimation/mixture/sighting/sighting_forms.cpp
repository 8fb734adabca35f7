#include <algorithm>
#include <cmath>

#include "auv_common/numbers/attitude.hpp"
#include "sighting_rows.hpp"

/// The numbers of detections, linearised at one component.
namespace stg::agent {

using dynamics::Detection;
using dynamics::MeasurementKind;

namespace {

/// An unknown depth bends successive ranges in the same way until the depth has changed. For this
/// effect, this number of ranges counts as one.
constexpr double kBentAlike = 15.0;

}  // namespace

SightingModel::Geometry SightingModel::GeometryOf(const Detection& d, int slot,
                                                  const GaussianMixture& mixture, int k) const {
  const Gaussian g = mixture.at(k);
  const int s = mixture.stride();
  Geometry at;
  at.d = {g.x[0] - d.p_WO.x, g.x[1] - d.p_WO.y, g.x[2] - d.p_WO.z};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) at.C[r][c] = g.P[r * s + c];
  }
  if (layout_.per_observer > 0) {
    const int b = layout_.block(slot);
    at.d.x += g.x[b];
    at.d.y += g.x[b + 1];
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 2; ++c) {
        at.C[r][c] += g.P[r * s + b + c];
        at.C[c][r] += g.P[r * s + b + c];
      }
    }
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 2; ++c) at.C[r][c] += g.P[(b + r) * s + b + c];
    }
  }
  at.level = std::max(std::hypot(at.d.x, at.d.y), 1e-6);
  at.range = std::max(Norm(at.d), 1e-6);
  return at;
}

SightingModel::Row SightingModel::RowOf(const Vec3<double>& u, int slot) const {
  Row row;
  row.Add(0, u.x);
  row.Add(1, u.y);
  row.Add(2, u.z);
  if (layout_.per_observer > 0) {
    row.Add(layout_.block(slot), u.x);
    row.Add(layout_.block(slot) + 1, u.y);
  }
  return row;
}

void SightingModel::AddHeading(double slope, int slot, Row* row) const {
  if (layout_.heading) row->Add(layout_.block(slot) + 2, slope);
}

SightingModel::Form SightingModel::RangeForm(const Detection& d, int slot,
                                             const GaussianMixture& mixture, int k) const {
  const Geometry at = GeometryOf(d, slot, mixture, k);
  const Vec3<double> u = at.d * (1.0 / at.range);
  const double std_m = std::max(d.range_std_m, floor_std_m_);
  // Second order: the mean distance to a wide target is larger than the distance to its middle.
  const double wide = std::max(0.0, at.C[0][0] + at.C[1][1] + at.C[2][2] - at.Along(u));
  const double bend = wide / (2.0 * at.range);
  const double level = at.level / at.range;
  const double tall = at.C[2][2] * level * level / (2.0 * at.range);
  const double variance = std_m * std_m + 2.0 * bend * bend + u.z * u.z * observer_depth_variance_;
  const double alike = 2.0 * kBentAlike * tall * tall;
  return {RowOf(u, slot), d.range_m - at.range - bend, variance, alike};
}

SightingModel::Form SightingModel::AzimuthForm(const Detection& d, double azimuth_rad, int slot,
                                               const Geometry& at, const Gaussian& g) const {
  const double noise = d.bearing_std_rad * d.bearing_std_rad;
  const Vec3<double> out{at.d.x / at.level, at.d.y / at.level, 0.0};
  const Vec3<double> side{-out.y, out.x, 0.0};
  const double square = at.level * at.level;
  const double far = at.Along(out), across = at.Along(side), mixed = at.Along(out, side);
  Row row = RowOf(side * (1.0 / at.level), slot);
  AddHeading(1.0, slot, &row);
  const double turned_by = layout_.heading ? g.x[layout_.block(slot) + 2] : 0.0;
  const double expected = std::atan2(at.d.y, at.d.x) - mixed / square + turned_by;
  const double bend = (mixed * mixed + far * across) / (square * square);
  return {row, WrapAngle(azimuth_rad - expected), noise + bend};
}

SightingModel::Form SightingModel::ElevationForm(const Detection& d, int slot,
                                                 const Geometry& at) const {
  const double noise = d.bearing_std_rad * d.bearing_std_rad;
  const Vec3<double> out{at.d.x / at.level, at.d.y / at.level, 0.0};
  const double r2 = at.range * at.range;
  const Vec3<double> up{-out.x * at.d.z / at.range, -out.y * at.d.z / at.range,
                        at.level / at.range};
  const Vec3<double> u = at.d * (1.0 / at.range);
  const double radial = at.Along(u), tilt = at.Along(up), cross = at.Along(u, up);
  const double slope = at.d.z / at.level;
  const double turned = at.Along({-out.y, out.x, 0.0}) / r2 * slope;
  const double rough = (cross * cross + radial * tilt) / (r2 * r2) + 0.5 * turned * turned +
                       observer_depth_variance_ / r2;
  return {RowOf(up * (1.0 / at.range), slot),
          d.elevation_rad - std::atan2(at.d.z, at.level) + cross / r2 + 0.5 * turned,
          noise + rough};
}

SightingModel::Point SightingModel::PointOf(const Detection& d, double azimuth_rad) const {
  Point point{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}, {}, d.p_WT - d.p_WO};
  if (d.kind == MeasurementKind::kPosition) {
    const double std_m = std::max(d.std_m, floor_std_m_);
    point.variance[0] = point.variance[1] = point.variance[2] = std_m * std_m;
    return point;
  }
  const double c = std::cos(d.elevation_rad), z = std::sin(d.elevation_rad);
  const double ca = std::cos(azimuth_rad), sa = std::sin(azimuth_rad);
  const double b = d.bearing_std_rad * d.bearing_std_rad, range2 = d.range_m * d.range_m;
  const double std_m = std::max(d.range_std_m, floor_std_m_), least = floor_std_m_ * floor_std_m_;
  point.axes[0] = {c * ca, c * sa, z};
  point.axes[1] = {-sa, ca, 0.0};
  point.axes[2] = {-z * ca, -z * sa, c};
  // Unbiased: noise in the direction shortens the mean horizontal position by the factor exp(-b).
  const double shortened = std::exp(0.5 * b);
  point.r = {d.range_m * c * ca * shortened * shortened, d.range_m * c * sa * shortened * shortened,
             d.range_m * z * shortened};
  point.variance[0] = std_m * std_m + range2 * b * b;
  point.variance[1] = std::max(range2 * c * c * b, least) + std_m * std_m * b;
  point.variance[2] = std::max(range2 * b, least) + std_m * std_m * b;
  return point;
}

SightingModel::Form SightingModel::PointForm(const Point& point, int axis, int slot,
                                             const Geometry& at, const Gaussian& g) const {
  const Vec3<double>&a = point.axes[axis], &r = point.r;
  const int heading = layout_.heading ? layout_.block(slot) + 2 : -1;
  Row row = RowOf(a, slot);
  // An error of the heading turns the measured line about the vertical.
  AddHeading(a.y * r.x - a.x * r.y, slot, &row);
  const double turned = heading < 0 ? 0.0 : (a.y * r.x - a.x * r.y) * g.x[heading];
  return {row, Dot(a, r - at.d) - turned,
          point.variance[axis] + a.z * a.z * observer_depth_variance_};
}

double SightingModel::ClutterVolume(const Detection& d) const {
  if (d.kind == MeasurementKind::kRange) return range_m_;
  if (d.kind == MeasurementKind::kBearing) return 2.0 * kPi * kPi;
  const double far = std::max(Norm(PointOf(d, d.azimuth_rad).r), 0.1 * range_m_);
  return 2.0 * kPi * kPi * far * far * range_m_;
}

SightingFit SightingModel::Fit(const Detection& d, int slot, bool mirror,
                               const GaussianMixture& mixture, int k) const {
  const double azimuth_rad = mirror ? d.mirror_azimuth_rad : d.azimuth_rad;
  const Gaussian g = mixture.at(k);
  const Geometry at = GeometryOf(d, slot, mixture, k);
  Form forms[3];
  const int n = dynamics::NumbersOf(d.kind);
  switch (d.kind) {
    case MeasurementKind::kRange:
      forms[0] = RangeForm(d, slot, mixture, k);
      break;
    case MeasurementKind::kBearing:
      forms[0] = AzimuthForm(d, azimuth_rad, slot, at, g);
      forms[1] = ElevationForm(d, slot, at);
      break;
    case MeasurementKind::kPosition:
    case MeasurementKind::kRangeBearing:
      for (int axis = 0; axis < 3; ++axis) {
        forms[axis] = PointForm(PointOf(d, azimuth_rad), axis, slot, at, g);
      }
      break;
  }
  // S = L Lt by columns; z = L^-1 innovation.
  double S[3][3] = {}, column[kMostStride], distance2 = 0.0, root = 1.0, z[3] = {};
  for (int c = 0; c < n; ++c) {
    S[c][c] = forms[c].row.Times(g, mixture.stride(), column) + forms[c].variance;
    for (int r = c + 1; r < n; ++r) S[r][c] = forms[r].row.Dot(column);
  }
  for (int c = 0; c < n; ++c) {
    for (int j = 0; j < c; ++j) S[c][c] -= S[c][j] * S[c][j];
    S[c][c] = std::sqrt(S[c][c]);
    for (int r = c + 1; r < n; ++r) {
      for (int j = 0; j < c; ++j) S[r][c] -= S[r][j] * S[c][j];
      S[r][c] /= S[c][c];
    }
    z[c] = forms[c].innovation;
    for (int j = 0; j < c; ++j) z[c] -= S[c][j] * z[j];
    z[c] /= S[c][c];
    distance2 += z[c] * z[c];
    root *= S[c][c] * std::sqrt(2.0 * kPi);
  }
  return {distance2, std::exp(-0.5 * distance2) / root};
}

}  // namespace stg::agent

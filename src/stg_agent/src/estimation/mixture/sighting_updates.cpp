#include <algorithm>
#include <cmath>

#include "auv_common/numbers/attitude.hpp"
#include "sighting_rows.hpp"

namespace stg::agent {

using dynamics::Detection;
using dynamics::MeasurementKind;

namespace {

/// Largest second-order error of the linearisation, as a share of the noise.
constexpr double kBendShare = 0.2;
/// An unknown depth bends successive ranges in the same way until the depth has changed. For this
/// effect, this number of ranges counts as one.
constexpr double kBentAlike = 15.0;
/// Largest deviation of the distance, as a share of it, for the linearisation of a bearing.
constexpr double kDepthShare = 0.5;
/// A distribution whose length exceeds its width by this factor is a cone with its tip at the
/// observer.
constexpr double kCone = 4.0;

/// Turns the covariance of the target's position with the line to it. The uncertainty along a line
/// of sight stays along the new line. A linear update would leave it along the old line. The two
/// lines would then cross at some distance, as if this distance had been measured.
void Turn(const Vec3<double>& u, const Vec3<double>& v, Gaussian g, int stride) {
  // Rotation of u to v: 1 + [w] + [w]^2 / (1 + u v) with w = u x v.
  const Vec3<double> w = Cross(u, v);
  const double f = 1.0 / (1.0 + Dot(u, v));
  const double R[3][3] = {
      {1.0 - f * (w.y * w.y + w.z * w.z), f * w.x * w.y - w.z, f * w.x * w.z + w.y},
      {f * w.x * w.y + w.z, 1.0 - f * (w.x * w.x + w.z * w.z), f * w.y * w.z - w.x},
      {f * w.x * w.z - w.y, f * w.y * w.z + w.x, 1.0 - f * (w.x * w.x + w.y * w.y)}};
  const auto turn = [&R](double* a, double* b, double* c) {
    const double x = *a, y = *b, z = *c;
    *a = R[0][0] * x + R[0][1] * y + R[0][2] * z;
    *b = R[1][0] * x + R[1][1] * y + R[1][2] * z;
    *c = R[2][0] * x + R[2][1] * y + R[2][2] * z;
  };
  for (int c = 0; c < stride; ++c) turn(g.P + c, g.P + stride + c, g.P + 2 * stride + c);
  for (int r = 0; r < stride; ++r) {
    double* row = g.P + r * stride;
    turn(row, row + 1, row + 2);
  }
}

double NormalDensity(double squared, double variance) {
  return std::exp(-0.5 * squared) / std::sqrt(2.0 * kPi * variance);
}

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

double SightingModel::Excess(const Detection& d, int slot, const GaussianMixture& mixture, int k,
                             double* Pa, double* variance) const {
  if (d.kind == MeasurementKind::kPosition || d.kind == MeasurementKind::kRangeBearing) return 0.0;
  const Geometry at = GeometryOf(d, slot, mixture, k);
  const Vec3<double> out{at.d.x / at.level, at.d.y / at.level, 0.0};
  const Vec3<double> side{-out.y, out.x, 0.0};
  Vec3<double> along = side;
  double excess;
  const double across = at.Along(side);
  if (d.kind == MeasurementKind::kRange) {
    // For a target straight below, any direction bends the range.
    if (at.level < 0.3 * at.range && at.Along(out) > across) along = out;
    excess = std::max(across, along.x == out.x ? at.Along(out) : 0.0) /
             (2.0 * at.range * kBendShare * std::max(d.range_std_m, floor_std_m_));
  } else {
    const double far = at.Along(out), mixed = at.Along(out, side);
    const double bend =
        std::sqrt(std::max(0.0, mixed * mixed + far * across)) / (at.level * at.level);
    const double by_bend = bend / (kBendShare * d.bearing_std_rad);
    const double by_depth = far / (kDepthShare * kDepthShare * at.level * at.level);
    const bool depth = by_depth > by_bend || far > across;
    excess = std::max(by_depth,
                      across > 4.0 * std::pow(d.bearing_std_rad * at.level, 2) ? by_bend : 0.0);
    if (depth) along = out;
  }
  if (excess <= 1.0) return excess;
  *variance = RowOf(along, slot).Times(mixture.at(k), mixture.stride(), Pa);
  return *variance > 0.0 ? excess : 0.0;
}

/// Returns the likelihood of the innovation. Does not change the weight.
double SightingModel::Take(const Row& row, double innovation, double variance, double alike,
                           double clutter, Gaussian g, int stride) const {
  double column[kMostStride];
  const double s = row.Times(g, stride, column) + variance;
  const double own = (1.0 - false_share_) * NormalDensity(innovation * innovation / s, s);
  const double likelihood = own + false_share_ * clutter;
  Apply(row, innovation, variance + alike, own / likelihood, g, stride);
  // The effect that many measurements share counts only once, for the weights as for the gain.
  return alike > 0.0 ? std::pow(likelihood, s / (s + alike)) : likelihood;
}

/// Update by a number that is true with a probability: the mixture of the states with and without
/// it, approximated by its moments.
void SightingModel::Apply(const Row& row, double innovation, double variance, double truth,
                          Gaussian g, int stride) const {
  double column[kMostStride];
  const double inverse = 1.0 / (row.Times(g, stride, column) + variance);
  const double gain = truth * inverse * innovation;
  const double spread = innovation * innovation * inverse;
  const double less = (truth - truth * (1.0 - truth) * spread) * inverse;
  for (int r = 0; r < stride; ++r) {
    g.x[r] += gain * column[r];
    const double f = less * column[r];
    double* p = g.P + r * stride;
    for (int c = 0; c < stride; ++c) p[c] -= f * column[c];
  }
}

void SightingModel::UpdateRange(const Detection& d, int slot, GaussianMixture* mixture,
                                int k) const {
  const Geometry at = GeometryOf(d, slot, *mixture, k);
  const Vec3<double> u = at.d * (1.0 / at.range);
  const double std_m = std::max(d.range_std_m, floor_std_m_);
  // Second order: the mean distance to a wide target is larger than the distance to its middle.
  const double wide = std::max(0.0, at.C[0][0] + at.C[1][1] + at.C[2][2] - at.Along(u));
  const double bend = wide / (2.0 * at.range);
  const double level = at.level / at.range;
  const double tall = at.C[2][2] * level * level / (2.0 * at.range);
  const double variance = std_m * std_m + 2.0 * bend * bend + u.z * u.z * observer_depth_variance_;
  const double alike = 2.0 * kBentAlike * tall * tall;
  const Gaussian g = mixture->at(k);
  const int stride = mixture->stride();
  // A range depends on the square of the depth difference, so it cannot distinguish above and
  // below. So it must not change the depth, which keeps its prior. The effect of the uncertain
  // depth on the other states is included.
  double *z = g.P + 2 * stride, *w = g.P + 5 * stride;
  const double kept[] = {g.x[2], g.x[5], z[2], z[5], w[5]};
  *g.weight *=
      Take(RowOf(u, slot), d.range_m - at.range - bend, variance, alike, 1.0 / range_m_, g, stride);
  g.x[2] = kept[0];
  g.x[5] = kept[1];
  // A range that is only partly believed may have widened the depth together with the rest. This is
  // kept, because a covariance in which only the depth is narrower would be invalid.
  if (z[2] >= kept[2] && w[5] >= kept[4]) return;
  z[2] = kept[2];
  z[5] = w[2] = kept[3];
  w[5] = kept[4];
}

void SightingModel::UpdateBearing(const Detection& d, double azimuth_rad, int slot,
                                  GaussianMixture* mixture, int k) const {
  const Gaussian g = mixture->at(k);
  const double noise = d.bearing_std_rad * d.bearing_std_rad;
  Geometry at = GeometryOf(d, slot, *mixture, k);
  const Vec3<double> before = at.d * (1.0 / at.range);
  Vec3<double> out{at.d.x / at.level, at.d.y / at.level, 0.0};
  const Vec3<double> side{-out.y, out.x, 0.0};
  const double square = at.level * at.level;
  const double far = at.Along(out), across = at.Along(side), mixed = at.Along(out, side);
  Row row = RowOf(side * (1.0 / at.level), slot);
  AddHeading(1.0, slot, &row);
  const double turned_by = layout_.heading ? g.x[layout_.block(slot) + 2] : 0.0;
  const double expected = std::atan2(at.d.y, at.d.x) - mixed / square + turned_by;
  const double bend = (mixed * mixed + far * across) / (square * square);
  *g.weight *= Take(row, WrapAngle(azimuth_rad - expected), noise + bend, 0.0, 0.5 / kPi, g,
                    mixture->stride());

  at = GeometryOf(d, slot, *mixture, k);
  out = {at.d.x / at.level, at.d.y / at.level, 0.0};
  const double r2 = at.range * at.range;
  const Vec3<double> up{-out.x * at.d.z / at.range, -out.y * at.d.z / at.range,
                        at.level / at.range};
  const Vec3<double> u = at.d * (1.0 / at.range);
  const double radial = at.Along(u), tilt = at.Along(up), cross = at.Along(u, up);
  const double slope = at.d.z / at.level;
  const double turned = at.Along({-out.y, out.x, 0.0}) / r2 * slope;
  const double rough = (cross * cross + radial * tilt) / (r2 * r2) + 0.5 * turned * turned +
                       observer_depth_variance_ / r2;
  *g.weight *= Take(RowOf(up * (1.0 / at.range), slot),
                    d.elevation_rad - std::atan2(at.d.z, at.level) + cross / r2 + 0.5 * turned,
                    noise + rough, 0.0, 1.0 / kPi, g, mixture->stride());

  at = GeometryOf(d, slot, *mixture, k);
  const Vec3<double> after = at.d * (1.0 / at.range);
  const double line = at.Along(after);
  if (line > kCone * (at.C[0][0] + at.C[1][1] + at.C[2][2] - line)) {
    Turn(before, after, g, mixture->stride());
  }
}

/// A detection that gives a point is linear in the state, along the three axes of its noise.
void SightingModel::UpdatePoint(const Detection& d, double azimuth_rad, int slot,
                                GaussianMixture* mixture, int k) const {
  const Gaussian g = mixture->at(k);
  Vec3<double> axes[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  double variance[3];
  Vec3<double> r = d.p_WT - d.p_WO;
  if (d.kind == MeasurementKind::kPosition) {
    const double std_m = std::max(d.std_m, floor_std_m_);
    variance[0] = variance[1] = variance[2] = std_m * std_m;
  } else {
    const double c = std::cos(d.elevation_rad), z = std::sin(d.elevation_rad);
    const double ca = std::cos(azimuth_rad), sa = std::sin(azimuth_rad);
    const double b = d.bearing_std_rad * d.bearing_std_rad, range2 = d.range_m * d.range_m;
    const double std_m = std::max(d.range_std_m, floor_std_m_), least = floor_std_m_ * floor_std_m_;
    axes[0] = {c * ca, c * sa, z};
    axes[1] = {-sa, ca, 0.0};
    axes[2] = {-z * ca, -z * sa, c};
    // Unbiased: noise in the direction shortens the mean horizontal position by the factor exp(-b).
    const double shortened = std::exp(0.5 * b);
    r = {d.range_m * c * ca * shortened * shortened, d.range_m * c * sa * shortened * shortened,
         d.range_m * z * shortened};
    variance[0] = std_m * std_m + range2 * b * b;
    variance[1] = std::max(range2 * c * c * b, least) + std_m * std_m * b;
    variance[2] = std::max(range2 * b, least) + std_m * std_m * b;
  }
  // A detection is true or false as a whole.
  const Geometry prior = GeometryOf(d, slot, *mixture, k);
  const int heading = layout_.heading ? layout_.block(slot) + 2 : -1;
  Row rows[3];
  double own = 1.0 - false_share_, column[kMostStride];
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3<double>& a = axes[axis];
    rows[axis] = RowOf(a, slot);
    // An error of the heading turns the measured line about the vertical.
    AddHeading(a.y * r.x - a.x * r.y, slot, &rows[axis]);
    variance[axis] += a.z * a.z * observer_depth_variance_;
    const double s = rows[axis].Times(g, mixture->stride(), column) + variance[axis];
    const double turned = heading < 0 ? 0.0 : (a.y * r.x - a.x * r.y) * g.x[heading];
    const double innovation = Dot(a, r - prior.d) - turned;
    own *= NormalDensity(innovation * innovation / s, s);
  }
  const double far = std::max(Norm(r), 0.1 * range_m_);
  const double likelihood = own + false_share_ / (2.0 * kPi * kPi * far * far * range_m_);
  *g.weight *= likelihood;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3<double>& a = axes[axis];
    const Geometry at = GeometryOf(d, slot, *mixture, k);
    const double turned = heading < 0 ? 0.0 : (a.y * r.x - a.x * r.y) * g.x[heading];
    Apply(rows[axis], Dot(a, r - at.d) - turned, variance[axis], own / likelihood, g,
          mixture->stride());
  }
}

void SightingModel::Update(const Detection& d, int slot, bool mirror, GaussianMixture* mixture,
                           int k) const {
  const double azimuth = mirror ? d.mirror_azimuth_rad : d.azimuth_rad;
  switch (d.kind) {
    case MeasurementKind::kRange:
      UpdateRange(d, slot, mixture, k);
      return;
    case MeasurementKind::kBearing:
      UpdateBearing(d, azimuth, slot, mixture, k);
      return;
    case MeasurementKind::kPosition:
    case MeasurementKind::kRangeBearing:
      UpdatePoint(d, azimuth, slot, mixture, k);
      return;
  }
}

}  // namespace stg::agent

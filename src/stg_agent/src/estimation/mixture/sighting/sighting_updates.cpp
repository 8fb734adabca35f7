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
  alignas(32) double column[kMostStride];
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
  alignas(32) double column[kMostStride];
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

void SightingModel::UpdateRange(const Detection& d, int slot, double rivals,
                                GaussianMixture* mixture, int k) const {
  const Form form = RangeForm(d, slot, *mixture, k);
  const Gaussian g = mixture->at(k);
  const int stride = mixture->stride();
  // A range depends on the square of the depth difference, so it cannot distinguish above and
  // below. So it must not change the depth, which keeps its prior. The effect of the uncertain
  // depth on the other states is included.
  double *z = g.P + 2 * stride, *w = g.P + 5 * stride;
  const double kept[] = {g.x[2], g.x[5], z[2], z[5], w[5]};
  *g.weight *= Take(form.row, form.innovation, form.variance, form.alike, (1.0 + rivals) / range_m_,
                    g, stride);
  g.x[2] = kept[0];
  g.x[5] = kept[1];
  // A range that is only partly believed may have widened the depth together with the rest. This is
  // kept, because a covariance in which only the depth is narrower would be invalid.
  if (z[2] >= kept[2] && w[5] >= kept[4]) return;
  z[2] = kept[2];
  z[5] = w[2] = kept[3];
  w[5] = kept[4];
}

/// Azimuth and elevation are two numbers of one detection, and rivals count for both: this trusts
/// them a little less than together.
void SightingModel::UpdateBearing(const Detection& d, double azimuth_rad, int slot, double rivals,
                                  GaussianMixture* mixture, int k) const {
  const Gaussian g = mixture->at(k);
  Geometry at = GeometryOf(d, slot, *mixture, k);
  const Vec3<double> before = at.d * (1.0 / at.range);
  const Form azimuth = AzimuthForm(d, azimuth_rad, slot, at, g);
  const double others = (1.0 + rivals) / kPi;
  *g.weight *= Take(azimuth.row, azimuth.innovation, azimuth.variance, 0.0, 0.5 * others, g,
                    mixture->stride());
  const Form elevation = ElevationForm(d, slot, GeometryOf(d, slot, *mixture, k));
  *g.weight *= Take(elevation.row, elevation.innovation, elevation.variance, 0.0, others, g,
                    mixture->stride());

  at = GeometryOf(d, slot, *mixture, k);
  const Vec3<double> after = at.d * (1.0 / at.range);
  const double line = at.Along(after);
  if (line > kCone * (at.C[0][0] + at.C[1][1] + at.C[2][2] - line)) {
    Turn(before, after, g, mixture->stride());
  }
}

/// A detection that gives a point is linear in the state, along the three axes of its noise.
void SightingModel::UpdatePoint(const Detection& d, double azimuth_rad, int slot, double rivals,
                                GaussianMixture* mixture, int k) const {
  const Gaussian g = mixture->at(k);
  const Point point = PointOf(d, azimuth_rad);
  // A detection is true or false as a whole.
  const Geometry prior = GeometryOf(d, slot, *mixture, k);
  double own = 1.0 - false_share_, column[kMostStride];
  for (int axis = 0; axis < 3; ++axis) {
    const Form form = PointForm(point, axis, slot, prior, g);
    const double s = form.row.Times(g, mixture->stride(), column) + form.variance;
    own *= NormalDensity(form.innovation * form.innovation / s, s);
  }
  const double likelihood = own + false_share_ * (1.0 + rivals) / ClutterVolume(d);
  *g.weight *= likelihood;
  for (int axis = 0; axis < 3; ++axis) {
    const Form form = PointForm(point, axis, slot, GeometryOf(d, slot, *mixture, k), g);
    Apply(form.row, form.innovation, form.variance, own / likelihood, g, mixture->stride());
  }
}

void SightingModel::Update(const Detection& d, int slot, bool mirror, double rivals,
                           GaussianMixture* mixture, int k) const {
  const double azimuth = mirror ? d.mirror_azimuth_rad : d.azimuth_rad;
  switch (d.kind) {
    case MeasurementKind::kRange:
      UpdateRange(d, slot, rivals, mixture, k);
      return;
    case MeasurementKind::kBearing:
      UpdateBearing(d, azimuth, slot, rivals, mixture, k);
      return;
    case MeasurementKind::kPosition:
    case MeasurementKind::kRangeBearing:
      UpdatePoint(d, azimuth, slot, rivals, mixture, k);
      return;
  }
}

}  // namespace stg::agent

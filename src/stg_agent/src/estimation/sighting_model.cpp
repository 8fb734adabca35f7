#include "sighting_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "auv_common/numbers/attitude.hpp"
#include "auv_dynamics/navigation/navigation_system.hpp"
#include "auv_dynamics/sensing/target_sensor.hpp"

namespace stg::agent {

using dynamics::Detection;
using dynamics::MeasurementKind;

namespace {

/// Observers whose errors a filter keeps apart; of larger swarms those heard last.
constexpr int kMostObservers = 8;
constexpr int kRing = 24, kRay = 8;  // components of a first range, a first bearing
/// Share of the noise that the second-order error of a linear view may have.
constexpr double kBendShare = 0.2;
/// Ranges that an unknown depth bends alike before it has become another one: so many count as one
/// as far as that goes.
constexpr double kBentAlike = 15.0;
/// Largest deviation of the distance, as a share of it, for a linear view of a bearing.
constexpr double kDepthShare = 0.5;
/// A component that is faster than it can be by one deviation has lost e^-1/2 after this time.
constexpr double kDoubt_s = 5.0;
/// Every detection is believed with some reserve, or a wrong track would never be given up.
constexpr double kLeastFalseShare = 1e-3;
constexpr int kMostStates = kTargetStates + 3 * kMostObservers;
constexpr int kMostStride = (kMostStates + 3) & ~3;

/// A distribution this much longer than wide is a cone with its tip at the observer.
constexpr double kCone = 4.0;

/// Turns the covariance of the target's position as the line to it has turned. What is uncertain
/// along a line of sight stays so along the new one; a linear update leaves it along the old one,
/// and the two lines would cross somewhere, which tells of a distance that nothing has measured.
void Turn(const Vec3<double>& u, const Vec3<double>& v, Gaussian g, int stride) {
  // Rotation of u to v: 1 + [w] + [w]^2 / (1 + u v), w = u x v.
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

/// The line from the observer to the target and its covariance, errors of the observer included.
struct SightingModel::Geometry {
  Vec3<double> d;       ///< target minus observer
  double C[3][3];       ///< covariance of d
  double range, level;  ///< length, and that of its horizontal part

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

/// The few numbers of a row that are not zero.
struct SightingModel::Row {
  std::array<int, 6> index{};
  std::array<double, 6> value{};
  int count = 0;

  void Add(int i, double v) {
    index[static_cast<std::size_t>(count)] = i;
    value[static_cast<std::size_t>(count++)] = v;
  }
  /// P times the row as a column; returns row P column.
  double Times(const Gaussian& g, int stride, double* column) const {
    std::fill_n(column, stride, 0.0);
    for (int k = 0; k < count; ++k) {
      const double v = value[static_cast<std::size_t>(k)];
      const double* p = g.P + index[static_cast<std::size_t>(k)] * stride;
      for (int c = 0; c < stride; ++c) column[c] += v * p[c];
    }
    double sum = 0.0;
    for (int k = 0; k < count; ++k) {
      sum += value[static_cast<std::size_t>(k)] * column[index[static_cast<std::size_t>(k)]];
    }
    return sum;
  }
};

SightingModel::SightingModel(const AgentConfig& s) {
  const auto navigation =
      dynamics::NavigationSystems().Make(s.navigation.kind, {s.navigation, s.agents, s.time.dt_s});
  const auto sensor = dynamics::TargetSensors().Make(s.sensing.sensor, s.sensing);
  if (!navigation->perfect()) {
    layout_.per_observer = sensor->kind() == MeasurementKind::kRange ? 2 : 3;
    layout_.observers = std::min(s.agents, kMostObservers);
  }
  observer_depth_variance_ =
      navigation->perfect() ? 0.0 : s.navigation.depth_std_m * s.navigation.depth_std_m;
  // Of a target that is as fast as it can be, in any horizontal direction.
  const double speed = s.track.velocity_std_mps > 0.0 ? s.track.velocity_std_mps
                                                      : s.target.max_speed_mps * std::sqrt(0.5);
  velocity_variance_ = speed * speed;
  max_speed_mps_ = s.target.max_speed_mps;
  velocity_memory_s_ = s.track.velocity_memory_s;
  const double low = s.sea.open ? -s.sea.target_depth_m.hi : -s.workspace.half_extent_m;
  const double high = s.sea.open ? -s.sea.target_depth_m.lo : s.workspace.half_extent_m;
  floor_std_m_ = s.track.measurement_std_m;
  depth_mean_ = 0.5 * (low + high);
  depth_variance_ = std::max((high - low) * (high - low) / 12.0, floor_std_m_ * floor_std_m_);
  range_m_ = s.sensing.range_m;
  false_share_ = std::max(kLeastFalseShare, 1.0 - (1.0 - s.sensing.outlier_probability) *
                                                      (1.0 - s.sensing.false_alarm_probability));
}

void SightingModel::Predict(double t, GaussianMixture* mixture) const {
  if (t <= 0.0) return;
  const double T = velocity_memory_s_, s = t / T, q = velocity_variance_;
  const double gone = -std::expm1(-s), a = 1.0 - gone, g = T * gone;
  const double vv = q * gone * (1.0 + a), pv = q * T * gone * gone;
  // 2 s - 3 + 4 a - a^2 loses its digits for short times; its series begins with 2 s^3 / 3.
  const double shape = s > 0.01 ? 2.0 * s - 3.0 + 4.0 * a - a * a
                                : s * s * s * (2.0 / 3.0 - 0.5 * s + 7.0 / 30.0 * s * s);
  const double pp = q * T * T * shape;
  const int stride = mixture->stride(), states = mixture->states();
  for (int k = 0; k < mixture->size(); ++k) {
    const Gaussian target = mixture->at(k);
    double* P = target.P;
    for (int i = 0; i < 3; ++i) {
      target.x[i] += g * target.x[i + 3];
      target.x[i + 3] *= a;
      double *p = P + i * stride, *v = P + (i + 3) * stride;
      for (int c = 0; c < stride; ++c) {
        p[c] += g * v[c];
        v[c] *= a;
      }
    }
    for (int r = 0; r < kTargetStates; ++r) {
      double* row = P + r * stride;
      for (int i = 0; i < 3; ++i) {
        row[i] += g * row[i + 3];
        row[i + 3] *= a;
      }
    }
    for (int r = kTargetStates; r < states; ++r) {
      for (int c = 0; c < kTargetStates; ++c) P[r * stride + c] = P[c * stride + r];
    }
    for (int i = 0; i < 3; ++i) {
      P[i * stride + i] += pp;
      P[i * stride + i + 3] += pv;
      P[(i + 3) * stride + i] += pv;
      P[(i + 3) * stride + i + 3] += vv;
    }
    const double depth = P[2 * stride + 2];
    if (depth > depth_variance_ * (1.0 + 1e-9)) {
      Row row;
      row.Add(2, 1.0);
      Take(row, depth_mean_ - target.x[2], depth_variance_ * depth / (depth - depth_variance_), 0.0,
           0.0, target, stride);
    }
  }
}

void SightingModel::Datum(const Vec3<double>& p_WT, double std_m, Gaussian g, int stride) const {
  const double variance = std::max(std_m * std_m, floor_std_m_ * floor_std_m_);
  const double p[3] = {p_WT.x, p_WT.y, p_WT.z};
  for (int i = 0; i < 3; ++i) {
    g.x[i] = p[i];
    g.P[i * stride + i] = variance;
    g.P[(i + 3) * stride + i + 3] = velocity_variance_;
  }
  const double known = 1.0 / (1.0 / variance + 1.0 / depth_variance_);
  g.x[2] = known * (p_WT.z / variance + depth_mean_ / depth_variance_);
  g.P[2 * stride + 2] = known;
}

void SightingModel::Seed(const Detection& d, GaussianMixture* mixture) const {
  mixture->Clear();
  const auto add = [&](const Vec3<double>& p_WT, double std_m) {
    const Gaussian g = mixture->Add();
    Datum(p_WT, std_m, g, mixture->stride());
  };
  if (d.kind == MeasurementKind::kRange) {
    const double dz = depth_mean_ - d.p_WO.z;
    const double level =
        std::sqrt(std::max(d.range_m * d.range_m - dz * dz, d.range_std_m * d.range_std_m));
    for (int k = 0; k < kRing; ++k) {
      const double angle = 2.0 * kPi * k / kRing;
      add({d.p_WO.x + level * std::cos(angle), d.p_WO.y + level * std::sin(angle), depth_mean_},
          1.2 * kPi * level / kRing + d.range_std_m);
    }
  } else if (d.kind == MeasurementKind::kBearing) {
    const double c = std::cos(d.elevation_rad), z = std::sin(d.elevation_rad);
    for (int k = 0; k < kRay; ++k) {
      const double r = range_m_ * std::pow(0.05, (k + 0.5) / kRay);
      for (const double azimuth : {d.azimuth_rad, d.mirror_azimuth_rad}) {
        add(d.p_WO + Vec3<double>{c * std::cos(azimuth), c * std::sin(azimuth), z} * r, 0.25 * r);
        if (!d.ambiguous) break;
      }
    }
  } else {
    add(d.p_WT, range_m_);
  }
  mixture->Normalise();
}

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
  if (layout_.per_observer > 2) row->Add(layout_.block(slot) + 2, slope);
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
    // A target straight below: any direction bends the range.
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

/// Returns the likelihood of the innovation; weighs nothing.
double SightingModel::Take(const Row& row, double innovation, double variance, double alike,
                           double clutter, Gaussian g, int stride) const {
  double column[kMostStride];
  const double s = row.Times(g, stride, column) + variance;
  const double squared = innovation * innovation / s;
  double likelihood = 1.0, truth = 1.0;
  if (clutter > 0.0) {
    const double own = (1.0 - false_share_) * NormalDensity(squared, s);
    likelihood = own + false_share_ * clutter;
    truth = own / likelihood;
  }
  // What many measurements share counts once among them, for the weights as for the gain.
  if (alike > 0.0) likelihood = std::pow(likelihood, s / (s + alike));
  // Mixture of what is with and without the measurement, by its moments.
  const double inverse = 1.0 / (s + alike);
  const double gain = truth * inverse * innovation;
  const double spread = innovation * innovation * inverse;
  const double less = (truth - truth * (1.0 - truth) * spread) * inverse;
  for (int r = 0; r < stride; ++r) {
    g.x[r] += gain * column[r];
    const double f = less * column[r];
    double* p = g.P + r * stride;
    for (int c = 0; c < stride; ++c) p[c] -= f * column[c];
  }
  return likelihood;
}

void SightingModel::UpdateRange(const Detection& d, int slot, GaussianMixture* mixture,
                                int k) const {
  const Geometry at = GeometryOf(d, slot, *mixture, k);
  const Vec3<double> u = at.d * (1.0 / at.range);
  const double std_m = std::max(d.range_std_m, floor_std_m_);
  // Second order: a wide target is farther off on the mean than its middle.
  const double wide = std::max(0.0, at.C[0][0] + at.C[1][1] + at.C[2][2] - at.Along(u));
  const double bend = wide / (2.0 * at.range);
  const double level = at.level / at.range;
  const double tall = at.C[2][2] * level * level / (2.0 * at.range);
  const double variance = std_m * std_m + 2.0 * bend * bend + u.z * u.z * observer_depth_variance_;
  const double alike = 2.0 * kBentAlike * tall * tall;
  const Gaussian g = mixture->at(k);
  const int stride = mixture->stride();
  // A range sees depth by its square, above and below alike: what it would say of it is not taken.
  // The depth stays what is known beforehand, and what it does to the rest is reckoned with.
  double *z = g.P + 2 * stride, *w = g.P + 5 * stride;
  const double kept[] = {g.x[2], g.x[5], z[2], z[5], w[5]};
  *g.weight *=
      Take(RowOf(u, slot), d.range_m - at.range - bend, variance, alike, 1.0 / range_m_, g, stride);
  g.x[2] = kept[0];
  g.x[5] = kept[1];
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
  const double turned_by = layout_.per_observer > 2 ? g.x[layout_.block(slot) + 2] : 0.0;
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

/// What gives a point is linear in the state: along the three axes of its noise.
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
    // Unbiased: noisy directions shorten the mean of the point by exp(-b) in the horizontal.
    const double shortened = std::exp(0.5 * b);
    r = {d.range_m * c * ca * shortened * shortened, d.range_m * c * sa * shortened * shortened,
         d.range_m * z * shortened};
    variance[0] = std_m * std_m + range2 * b * b;
    variance[1] = std::max(range2 * c * c * b, least) + std_m * std_m * b;
    variance[2] = std::max(range2 * b, least) + std_m * std_m * b;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3<double>& a = axes[axis];
    const Geometry at = GeometryOf(d, slot, *mixture, k);
    Row row = RowOf(a, slot);
    // A heading error turns the measured line about the vertical; the line itself is uncertain.
    const double turn = a.y * r.x - a.x * r.y;
    AddHeading(turn, slot, &row);
    const double turned = layout_.per_observer > 2 ? turn * g.x[layout_.block(slot) + 2] : 0.0;
    *g.weight *=
        Take(row, Dot(a, r - at.d) - turned, variance[axis] + a.z * a.z * observer_depth_variance_,
             0.0, 0.5 / range_m_, g, mixture->stride());
  }
}

void SightingModel::DoubtTheFast(double dt_s, GaussianMixture* mixture) const {
  for (int k = 0; k < mixture->size(); ++k) {
    const Gaussian g = mixture->at(k);
    const double over = std::hypot(g.x[3], g.x[4]) - max_speed_mps_;
    if (over <= 0.0) continue;
    *g.weight *= std::exp(-0.5 * over * over / velocity_variance_ * dt_s / kDoubt_s);
  }
  mixture->Normalise();
}

bool SightingModel::AddMirror(const Vec3<double>& p_WA, const Vec3<double>& p_WB, double weight,
                              GaussianMixture* mixture) const {
  int heaviest = 0;
  for (int k = 1; k < mixture->size(); ++k) {
    if (*mixture->at(k).weight > *mixture->at(heaviest).weight) heaviest = k;
  }
  const int stride = mixture->stride();
  const Vec3<double> line{p_WB.x - p_WA.x, p_WB.y - p_WA.y, 0.0};
  const double length = std::hypot(line.x, line.y);
  if (length < 1e-3) return false;
  const double nx = -line.y / length, ny = line.x / length;
  const Gaussian from = mixture->at(heaviest);
  const double off = nx * (from.x[0] - p_WA.x) + ny * (from.x[1] - p_WA.y);
  const double variance =
      nx * nx * from.P[0] + 2.0 * nx * ny * from.P[1] + ny * ny * from.P[stride + 1];
  if (off * off < 4.0 * variance) return false;
  const Gaussian g = mixture->Copy(heaviest);
  *g.weight = weight;
  g.x[0] -= 2.0 * off * nx;
  g.x[1] -= 2.0 * off * ny;
  const auto reflect = [nx, ny](double* x, double* y) {
    const double along = 2.0 * (nx * *x + ny * *y);
    *x -= along * nx;
    *y -= along * ny;
  };
  for (int c = 0; c < stride; ++c) reflect(g.P + c, g.P + stride + c);
  for (int r = 0; r < stride; ++r) reflect(g.P + r * stride, g.P + r * stride + 1);
  for (int i = 3; i < kTargetStates; ++i) {
    g.x[i] = 0.0;
    for (int c = 0; c < stride; ++c) g.P[i * stride + c] = g.P[c * stride + i] = 0.0;
    g.P[i * stride + i] = velocity_variance_;
  }
  return true;
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

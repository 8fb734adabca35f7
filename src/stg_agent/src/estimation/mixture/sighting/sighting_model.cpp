#include "sighting_model.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/numbers/attitude.hpp"
#include "auv_dynamics/navigation/navigation_system.hpp"
#include "auv_dynamics/sensing/target_sensor.hpp"
#include "sighting_rows.hpp"

namespace stg::agent {

using dynamics::Detection;
using dynamics::MeasurementKind;

namespace {

constexpr int kRing = 24, kRay = 8;  // components of a first range and of a first bearing
/// A component that is one deviation faster than possible loses the factor e^-1/2 in this time [s].
constexpr double kDoubt_s = 5.0;
/// No detection is trusted completely; otherwise the filter could not leave a wrong track.
constexpr double kLeastFalseShare = 1e-3;

}  // namespace

SightingModel::SightingModel(const AgentModel& s) {
  const auto navigation = dynamics::NavigationSystems().Make(
      s.navigation.kind, s.navigation.kinds,
      {s.navigation, s.run.agents, s.run.time.dt_s, s.navigation});
  const auto sensor =
      dynamics::TargetSensors().Make(s.sensing.sensor, s.sensing.sensors, s.sensing);
  if (!navigation->perfect()) {
    layout_.heading = sensor->kind() != MeasurementKind::kRange;
    layout_.rates = s.track.observers == ObserverErrors::kRates;
    layout_.located = s.track.observers == ObserverErrors::kLocated;
    layout_.per_observer = layout_.rate() + (layout_.rates ? 2 : 0);
    layout_.observers = std::min(s.run.agents, layout_.rates ? kMostObservers : kSteadyObservers);
  }
  observer_depth_variance_ =
      navigation->perfect() ? 0.0 : s.navigation.depth_std_m * s.navigation.depth_std_m;
  // Velocity of a target at its largest speed in any horizontal direction.
  const double speed = s.track.velocity_std_mps > 0.0 ? s.track.velocity_std_mps
                                                      : s.target.max_speed_mps * std::sqrt(0.5);
  velocity_variance_ = speed * speed;
  max_speed_mps_ = s.target.max_speed_mps;
  if (layout_.rates) {
    // In a frame that moves with the water, the target moves relative to it.
    velocity_variance_ += s.navigation.current_std_mps * s.navigation.current_std_mps;
    max_speed_mps_ += 2.0 * s.navigation.current_std_mps;
  }
  velocity_memory_s_ = s.track.velocity_memory_s;
  const double low = s.sea.open ? -s.sea.target_depth_m.hi : -s.workspace.half_extent_m;
  const double high = s.sea.open ? -s.sea.target_depth_m.lo : s.workspace.half_extent_m;
  floor_std_m_ = s.track.measurement_std_m;
  depth_mean_ = 0.5 * (low + high);
  depth_variance_ = std::max((high - low) * (high - low) / 12.0, floor_std_m_ * floor_std_m_);
  range_m_ = s.sensing.range_m;
  const dynamics::RelativeOptions relative = s.sensing.relative();
  false_share_ = std::max(kLeastFalseShare, 1.0 - (1.0 - relative.outlier_probability) *
                                                      (1.0 - relative.false_alarm_probability));
}

void SightingModel::Predict(double t, GaussianMixture* mixture) const {
  if (t <= 0.0) return;
  const double T = velocity_memory_s_, s = t / T, q = velocity_variance_;
  const double gone = -std::expm1(-s), a = 1.0 - gone, g = T * gone;
  const double vv = q * gone * (1.0 + a), pv = q * T * gone * gone;
  // 2 s - 3 + 4 a - a^2 loses its digits for short times, so its series is used, which begins with
  // 2 s^3 / 3.
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
      Apply(row, depth_mean_ - target.x[2], depth_variance_ * depth / (depth - depth_variance_),
            1.0, target, stride);
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

}  // namespace stg::agent

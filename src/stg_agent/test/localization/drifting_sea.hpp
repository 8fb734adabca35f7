#pragma once

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "stg_agent/localization/joint_filter.hpp"

/// AUVs that drift with the water and measure ranges to each other and to stations. The numbers are
/// drawn from the model that the joint filter assumes. There are no packets, channel or vehicles,
/// so that a test sees the filter alone.
namespace stg::agent {

struct DriftOptions {
  int auvs = 4;
  bool craft = false;
  double craft_std_m = 2.0;   ///< deviation of the position that the craft tells
  double usbl_std_deg = 0.0;  ///< deviation of the bearings at which the craft hears AUVs; 0: none
  double head_std_deg = 0.0;  ///< deviation of the directions that AUV 0 measures; 0: none
  HeadingModel headings;      ///< errors of the AUVs' headings
  int beacons = 0;
  double seconds = 3600.0;
  double slot_s = 1.25;
  double loss = 0.0;
  double late = 0.0;          ///< share of ranges that are late
  bool ranges = true;         ///< false: no AUV measures ranges
  ClockModel clocks;          ///< clocks of AUVs and beacons; the clock of the craft is right
  double fix_period_s = 0.0;  ///< time between two fixes of AUV 1, which have 3 m; 0: none
  double shift_m = 0.0;       ///< shift of all true positions, which no AUV measures
  double drift_mps = 0.0;     ///< growth of this shift
};

/// The result of the filter of AUV 0 at the end.
struct DriftResult {
  PlaneError own, relative, current, mean_error;
  double error_x = 0.0, error_y = 0.0;  ///< true error of the own position less the stated one
  double relative_x = 0.0, relative_y = 0.0;  ///< the same of AUV 1 against AUV 0
  double current_x = 0.0, current_y = 0.0;
  double nis = 0.0;  ///< mean over all ranges that were taken
  int ranges = 0, aside = 0;

  static double Nees(double x, double y, const PlaneError& P) {
    const double det = P.xx * P.yy - P.xy * P.xy;
    return (P.yy * x * x - 2.0 * P.xy * x * y + P.xx * y * y) / det;
  }
};

class DriftingSea {
 public:
  DriftingSea(const LocalizationConfig& config, const DriftOptions& o) : c_(config), o_(o) {
    if (o.craft) anchors_.push_back({o.craft_std_m, 600.0});
    for (int k = 0; k < o.beacons; ++k) anchors_.push_back({1.0, 0.0, false});
  }

  DriftResult Run(unsigned seed) {
    random_.seed(seed);
    JointFilter filter(c_, 1.0, o_.auvs, anchors_, 0, o_.clocks, o_.headings);
    const auto n = static_cast<std::size_t>(o_.auvs);
    std::vector<double> e(2 * n), w(2 * n), g(2 * anchors_.size());
    double C[2];
    for (double& x : e) x = Normal();
    for (double& x : w) x = c_.shear_std_mps * Normal();
    for (double& x : C) x = c_.current_std_mps * Normal();
    for (std::size_t k = 0; k < g.size(); ++k) g[k] = anchors_[k / 2].std_m * Normal();
    const double kappa = c_.sound_speed_std * Normal();
    const int members = o_.auvs + static_cast<int>(anchors_.size());
    std::vector<double> offset(static_cast<std::size_t>(members)), rate(offset.size());
    const ClockModel& clocks = o_.clocks;
    for (std::size_t k = 0; k < offset.size() && clocks.offset_std_s + clocks.rate_std > 0.0; ++k) {
      if (static_cast<int>(k) == o_.auvs && o_.craft) continue;
      offset[k] = clocks.offset_std_s * Normal();
      rate[k] = clocks.rate_std * Normal();
    }
    const auto ahead_s = [&](int id, double t) {
      return offset[static_cast<std::size_t>(id)] + rate[static_cast<std::size_t>(id)] * t;
    };
    std::vector<double> h(n);
    std::vector<Vec3<double>> sent(n);
    for (std::size_t i = 0; i < n && o_.headings.std_rad > 0.0; ++i) {
      h[i] = o_.headings.std_rad * Normal();
      sent[i] = Overheard(static_cast<int>(i), 0.0, e, g);
    }
    /// The filter takes the way of an AUV since the last packet of which it knows.
    const auto go = [&](int id, double t) {
      if (o_.headings.std_rad <= 0.0 || id >= o_.auvs) return;
      const Vec3<double> p = Overheard(id, t, e, g);
      filter.Turn(id, p - sent[static_cast<std::size_t>(id)]);
      sent[static_cast<std::size_t>(id)] = p;
    };
    DriftResult r;
    const auto slots = static_cast<int>(o_.seconds / o_.slot_s);
    for (int s = 1; s <= slots; ++s) {
      const double t = s * o_.slot_s, dt = o_.slot_s;
      for (std::size_t k = 0; k < e.size(); ++k) {
        e[k] += -(C[k % 2] + w[k]) * dt + c_.reckoning_std_m * std::sqrt(dt) * Normal();
        Renew(c_.shear_std_mps, c_.shear_memory_s, dt, &w[k]);
      }
      for (std::size_t i = 0; i < n && o_.headings.std_rad > 0.0; ++i) {
        const int id = static_cast<int>(i);
        h[i] += o_.headings.walk_rad * std::sqrt(dt) * Normal();
        const Vec3<double> way = True(id, t) - True(id, t - dt);
        e[2 * i] -= h[i] * (way.y - (C[1] + w[2 * i + 1]) * dt);
        e[2 * i + 1] += h[i] * (way.x - (C[0] + w[2 * i]) * dt);
      }
      for (double& x : C) Renew(c_.current_std_mps, c_.current_memory_s, dt, &x);
      for (std::size_t k = 0; k < g.size(); ++k) {
        if (anchors_[k / 2].memory_s > 0.0) {
          Renew(anchors_[k / 2].std_m, anchors_[k / 2].memory_s, dt, &g[k]);
        }
      }
      const auto now = static_cast<TimeNs>(t * 1e9);
      filter.Predict(now);
      go(0, t);
      const double period = o_.fix_period_s;
      if (period > 0.0 && t < o_.seconds && std::fmod(t, period) < 0.5 * dt) {
        filter.Take(FixReading{1, now, e[2] + 3.0 * Normal(), e[3] + 3.0 * Normal(), 3.0});
      }
      if (!o_.ranges) continue;
      const int source = s % members;
      for (int receiver = 0; receiver < o_.auvs; ++receiver) {
        if (receiver == source) continue;
        const bool lost = std::uniform_real_distribution<double>()(random_) < o_.loss;
        const double noise = c_.range_std_m * Normal();
        const bool late = std::uniform_real_distribution<double>()(random_) < o_.late;
        const double by = std::uniform_real_distribution<double>(5.0, 100.0)(random_);
        if (lost) continue;
        if (receiver == 0) go(source, t);
        if (receiver == 0 && o_.head_std_deg > 0.0) HearDirection(source, t, h[0], e, g, &filter);
        RangeReading z;
        z.receiver = receiver;
        z.source = source;
        z.at = now;
        z.p_receiver = Overheard(receiver, t, e, g);
        z.p_source = Overheard(source, t, e, g);
        const Vec3<double> way = True(receiver, t) - True(source, t);
        z.range_m = (1.0 + kappa) * Norm(way) + noise + (late ? by : 0.0) +
                    z.sound_mps * (ahead_s(receiver, t) - ahead_s(source, t));
        if (filter.Take(z)) {
          r.nis += filter.last_nis();
          ++r.ranges;
        } else {
          ++r.aside;
        }
      }
      if (o_.usbl_std_deg > 0.0 && source < o_.auvs) HearBearing(source, t, e, g, &filter);
    }
    r.nis /= std::max(1, r.ranges);
    r.own = filter.Error(0, filter.now());
    r.relative = filter.Relative(1, 0, filter.now());
    r.current = filter.Current();
    r.mean_error = filter.MeanError();
    r.error_x = e[0] - r.own.x;
    r.error_y = e[1] - r.own.y;
    r.relative_x = e[2] - e[0] - r.relative.x;
    r.relative_y = e[3] - e[1] - r.relative.y;
    r.current_x = C[0] - r.current.x;
    r.current_y = C[1] - r.current.y;
    return r;
  }

 private:
  /// A bearing that the craft measures.
  void HearBearing(int source, double t, const std::vector<double>& e, const std::vector<double>& g,
                   JointFilter* filter) {
    if (std::uniform_real_distribution<double>()(random_) < o_.loss) return;
    BearingReading z;
    z.receiver = o_.auvs;
    z.source = source;
    z.at = filter->now();
    z.p_receiver = Overheard(z.receiver, t, e, g);
    z.p_source = Overheard(source, t, e, g);
    z.std_rad = o_.usbl_std_deg * kTurn / 180.0;
    const Vec3<double> way = True(source, t) - True(z.receiver, t);
    z.azimuth_rad = std::atan2(way.y, way.x) + z.std_rad * Normal();
    filter->Take(z);
  }
  /// A direction that AUV 0 measures.
  void HearDirection(int source, double t, double turned, const std::vector<double>& e,
                     const std::vector<double>& g, JointFilter* filter) {
    DirectionReading z;
    z.source = source;
    z.at = filter->now();
    z.p_receiver = Overheard(0, t, e, g);
    z.p_source = Overheard(source, t, e, g);
    z.std_rad = o_.head_std_deg * kTurn / 180.0;
    const Vec3<double> way = True(source, t) - True(0, t);
    const double level = std::hypot(way.x, way.y);
    z.azimuth_rad = std::atan2(way.y, way.x) + turned + z.std_rad * Norm(way) / level * Normal();
    z.elevation_rad = std::atan2(way.z, level) + z.std_rad * Normal();
    filter->Take(z);
  }
  double Normal() { return std::normal_distribution<double>()(random_); }
  void Renew(double std, double memory_s, double dt, double* x) {
    const double kept = std::exp(-dt / memory_s);
    *x = kept * *x + std * std::sqrt(1.0 - kept * kept) * Normal();
  }

  /// The AUVs fly circles of 90 m around a target that goes in a wide curve. The craft's circle has
  /// 300 m.
  Vec3<double> True(int id, double t) const {
    const double at = 0.0007 * t;
    const Vec3<double> target{800.0 * std::sin(at) + o_.shift_m + o_.drift_mps * t,
                              800.0 * (1.0 - std::cos(at)), -40.0};
    if (id < o_.auvs) {
      const double angle = 2.0 * kTurn * id / o_.auvs + (0.010 + 0.0007 * id) * t;
      const double depth = -20.0 - 40.0 * id / std::max(1, o_.auvs - 1);
      return {target.x + 90.0 * std::cos(angle), target.y + 90.0 * std::sin(angle), depth};
    }
    const int k = id - o_.auvs - (o_.craft ? 1 : 0);
    if (k < 0) {
      const double angle = 1.5 / 300.0 * t;
      return {target.x + 300.0 * std::cos(angle), target.y + 300.0 * std::sin(angle), 0.0};
    }
    const double x[] = {1500.0, -1500.0, -1500.0, 1500.0}, y[] = {1500.0, -1500.0, 1500.0, -1500.0};
    return {x[k] + o_.shift_m + o_.drift_mps * t, y[k], -100.0};
  }

  Vec3<double> Overheard(int id, double t, const std::vector<double>& e,
                         const std::vector<double>& g) const {
    const std::vector<double>& error = id < o_.auvs ? e : g;
    const auto k = static_cast<std::size_t>(2 * (id < o_.auvs ? id : id - o_.auvs));
    Vec3<double> p = True(id, t) + Vec3<double>{error[k], error[k + 1], 0.0};
    // No AUV measures the shift, so it is not in the position that is sent.
    p.x -= o_.shift_m + o_.drift_mps * t;
    return p;
  }

  static constexpr double kTurn = 3.14159265358979323846;
  LocalizationConfig c_;
  DriftOptions o_;
  std::vector<AnchorModel> anchors_;
  std::mt19937_64 random_;
};

}  // namespace stg::agent

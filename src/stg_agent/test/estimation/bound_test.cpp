// Compares the filter of measurements with the posterior Cramer-Rao bound of the target's position
// (Tichavsky, Muravchik, Nehorai 1998). The bound follows each episode's truth. It uses the
// measurements of all observers without any delay. Navigation is perfect, the prior is the cue, and
// the model of the target is the filter's own.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <vector>

#include "estimation/fleet.hpp"

namespace stg::agent {
namespace {

constexpr int kFlights = 200, kSeconds = 150, kEvery = 50;
constexpr int kTimes = kSeconds / kEvery;
using Matrix6 = Eigen::Matrix<double, 6, 6>;  // over position and velocity

/// One second of the target's model: an Ornstein-Uhlenbeck velocity in the plane, a constant depth.
void Predict(double std_mps, double memory_s, Matrix6* P) {
  const double phi = std::exp(-1.0 / memory_s), var = std_mps * std_mps;
  Matrix6 F = Matrix6::Identity(), Q = Matrix6::Zero();
  for (int axis = 0; axis < 2; ++axis) {
    F(axis, axis + 3) = memory_s * (1.0 - phi);
    F(axis + 3, axis + 3) = phi;
    Q(axis, axis) = var * memory_s * memory_s * (2.0 / memory_s - 3.0 + 4.0 * phi - phi * phi);
    Q(axis, axis + 3) = Q(axis + 3, axis) = var * memory_s * (1.0 - phi) * (1.0 - phi);
    Q(axis + 3, axis + 3) = var * (1.0 - phi * phi);
  }
  *P = F * *P * F.transpose() + Q;
}

struct Bounded {
  std::array<double, kTimes> error_m{}, bound_m{};
};

Bounded Compare(int observers) {
  FleetOptions o;
  o.observers = observers;
  o.drift = false;
  o.seconds = kSeconds;
  const AgentScenario s = FleetScenario(o);
  const double speed = s.world.target.max_speed_mps / std::sqrt(2.0);
  const double depth = s.world.sea.target_depth_m.hi - s.world.sea.target_depth_m.lo;
  Matrix6 prior = Matrix6::Identity() * speed * speed;
  prior.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() * o.cue_std_m * o.cue_std_m;
  // The filter knows that the depth is uniform in this interval.
  prior(2, 2) = depth * depth / 12.0;
  prior(5, 5) = 1e-9;
  const dynamics::RelativeOptions sensor = s.world.sensing.relative();
  Fleet fleet(s, o);
  Bounded r;
  for (int e = 0; e < kFlights; e += kLanes) {
    std::vector<Matrix6> P(kLanes, prior);
    int lane = 0;
    fleet.Fly(static_cast<std::uint64_t>(7000 + e), kSeconds, [&](const Judgement& j, int second) {
      Matrix6& p = P[static_cast<std::size_t>(lane)];
      Predict(speed, s.agent.track.velocity_memory_s, &p);
      Matrix6 information = p.inverse();
      for (int i = 0; i < observers; ++i) {
        const Vec3<double> r_BT =
            Lane(fleet.world().target(0).p_WT, lane) - Lane(fleet.world().vehicle(i).p_WB, lane);
        const double range = Norm(r_BT);
        const double std_m = sensor.range_std_m + sensor.range_std_share * range;
        Eigen::Matrix<double, 6, 1> h = Eigen::Matrix<double, 6, 1>::Zero();
        h.head<3>() << r_BT.x / range, r_BT.y / range, r_BT.z / range;
        const double found = s.world.sensing.detection_probability;
        information += found / (std_m * std_m) * h * h.transpose();
      }
      p = information.inverse();
      if ((second + 1) % kEvery == 0) {
        const auto check = static_cast<std::size_t>((second + 1) / kEvery - 1);
        r.bound_m[check] += (p(0, 0) + p(1, 1)) / kFlights;
        r.error_m[check] += j.error_m * j.error_m / kFlights;
      }
      lane = (lane + 1) % kLanes;
    });
  }
  for (auto* row : {&r.error_m, &r.bound_m}) {
    for (double& x : *row) x = std::sqrt(x);
  }
  return r;
}

class Bound : public ::testing::TestWithParam<int> {};

TEST_P(Bound, OfRangesIsApproachedAndNotUndercut) {
  const Bounded r = Compare(GetParam());
  for (std::size_t k = 0; k < kTimes; ++k) {
    std::printf("%d AUVs, %3zu s: error %.2f m, bound %.2f m\n", GetParam(), (k + 1) * kEvery,
                r.error_m[k], r.bound_m[k]);
    // The root mean square of 200 errors of two components has a relative error of 1 / sqrt(800).
    // Three of these are allowed.
    EXPECT_GT(r.error_m[k], (1.0 - 3.0 / std::sqrt(800.0)) * r.bound_m[k]);
  }
}

INSTANTIATE_TEST_SUITE_P(Ranges, Bound, ::testing::Values(1, 2, 4));

}  // namespace
}  // namespace stg::agent

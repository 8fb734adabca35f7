// The filter of measurements alone: what it makes of single detections. The time and the order in
// which they come must not matter.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <random>

#include "auv_common/config/loader.hpp"
#include "estimation/fleet.hpp"

namespace stg::agent {
namespace {

constexpr TimeNs kSecond = 1'000'000'000;

AgentModel Scenario(const char* sensor, bool drift = false) {
  FleetOptions o;
  o.sensor = sensor;
  o.drift = drift;
  o.observers = 4;
  return FleetScenario(o).model();
}

std::unique_ptr<TargetFilter> Filter(const AgentModel& s, int self = 0) {
  auto filter = TargetFilters().Make(s.track.filter, s, self);
  filter->Clear();
  return filter;
}

dynamics::Detection Range(TimeNs stamp, const Vec3<double>& p_WO, double range_m) {
  dynamics::Detection d;
  d.stamp = stamp;
  d.kind = dynamics::MeasurementKind::kRange;
  d.p_WO = d.p_WT = p_WO;
  d.range_m = range_m;
  d.range_std_m = 1.0 + 0.01 * range_m;
  return d;
}

NeighbourState Shared(int source, const dynamics::Detection& d) {
  NeighbourState state;
  state.source = source;
  state.generation = d.stamp;
  state.has_target = true;
  state.sightings.push_back(d);
  return state;
}

void Step(TargetFilter* f, TimeNs now) {
  f->Predict(now);
  f->Settle(now, {});
}

/// Smallest eigenvalue of the covariance of the position [m^2].
double Narrowest(const TargetBelief& b) {
  const Covariance3& P = b.P_WT;
  Eigen::Matrix3d m;
  m << P.xx, P.xy, P.xz, P.xy, P.yy, P.yz, P.xz, P.yz, P.zz;
  return m.allFinite() ? m.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff() : -1.0;
}

TEST(MeasurementFilter, RangesThatAreHalfBelievedLeaveACovariance) {
  const AgentModel s = Scenario("range");
  const Vec3<double> target{0.0, 0.0, -50.0};
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> angle(-kPi, kPi), off(-60.0, 60.0), distance(5.0, 120.0);
  for (int flight = 0; flight < 50; ++flight) {
    auto f = Filter(s);
    f->Start(target, 10.0, 0);
    for (int k = 0; k < 60; ++k) {
      const double a = angle(random), r = distance(random);
      const Vec3<double> p_WO{r * std::cos(a), r * std::sin(a), -20.0};
      // One range in four has a random error.
      const double wrong = k % 4 == 3 ? off(random) : 0.0;
      f->Predict(k * kSecond);
      f->Detect(Range(k * kSecond, p_WO, std::max(1.0, Norm(target - p_WO) + wrong)));
      f->Settle(k * kSecond, {});
      ASSERT_GT(Narrowest(f->belief()), 0.0) << "flight " << flight << ", range " << k;
    }
  }
}

TEST(MeasurementFilter, StartsFromTheCueWithTheDepthThatIsKnown) {
  const AgentModel s = Scenario("range");
  auto f = Filter(s);
  EXPECT_FALSE(f->belief().started);
  f->Start({10.0, 20.0, -30.0}, 50.0, 0);
  Step(f.get(), 0);
  const TargetBelief b = f->belief();
  EXPECT_TRUE(b.started);
  EXPECT_FALSE(b.observed);
  EXPECT_EQ(b.p_WT.x, 10.0);
  EXPECT_EQ(b.p_WT.y, 20.0);
  EXPECT_NEAR(b.P_WT.xx, 2500.0, 1e-9);
  // The depth is the product of the cue and of a uniform interval of 40 m.
  const double interval = 1600.0 / 12.0, both = 1.0 / (1.0 / 2500.0 + 1.0 / interval);
  EXPECT_NEAR(b.P_WT.zz, both, 1e-9);
  EXPECT_NEAR(b.p_WT.z, both * (-30.0 / 2500.0 - 40.0 / interval), 1e-9);
}

TEST(MeasurementFilter, PredictionIsTheIntegratedOrnsteinUhlenbeckProcess) {
  AgentModel s = Scenario("range");
  s.track.velocity_std_mps = 0.5;
  s.track.velocity_memory_s = 40.0;
  auto once = Filter(s);
  once->Start({0.0, 0.0, -40.0}, 5.0, 0);
  Step(once.get(), 80 * kSecond);
  // The velocity is stationary, so the variance of the way is 2 q T^2 (t/T - 1 + exp(-t/T)).
  const double expected = 25.0 + 2.0 * 0.25 * 1600.0 * (2.0 - 1.0 + std::exp(-2.0));
  EXPECT_NEAR(once->belief().P_WT.xx, expected, 1e-9);
  // The result does not depend on the number of predictions.
  auto often = Filter(s);
  often->Start({0.0, 0.0, -40.0}, 5.0, 0);
  for (int k = 1; k <= 80; ++k) Step(often.get(), k * kSecond);
  EXPECT_EQ(often->belief().P_WT.xx, once->belief().P_WT.xx);
  // The depth is never less certain than its interval.
  EXPECT_NEAR(once->belief().P_WT.zz, 1600.0 / 12.0, 1e-6);
}

TEST(MeasurementFilter, ARangeOfACertainTargetIsTheScalarKalmanFilter) {
  AgentModel s = Scenario("range");
  s.track.velocity_std_mps = 1e-9;
  auto f = Filter(s);
  f->Start({1000.0, 0.0, -40.0}, 2.0, 0);
  f->Detect(Range(0, {0.0, 0.0, -40.0}, 1003.0));
  Step(f.get(), 0);
  const double r = 1.0 + 0.01 * 1003.0, share = 4.0 / (4.0 + r * r);
  EXPECT_NEAR(f->belief().p_WT.x, 1000.0 + share * 3.0, 0.02);
  EXPECT_NEAR(f->belief().P_WT.xx, 4.0 * (1.0 - share), 0.02);
  EXPECT_NEAR(f->belief().P_WT.yy, 4.0, 1e-6);
}

TEST(MeasurementFilter, NeitherTimeNorOrderOfArrivalMatters) {
  for (const bool drift : {false, true}) {
    const AgentModel s = Scenario("range", drift);
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    struct Item {
      int source;
      dynamics::Detection d;
    };
    std::vector<Item> items;
    for (int k = 0; k < 40; ++k) {
      for (int i = 0; i < 4; ++i) {
        if ((k + i) % 3 == 0) continue;
        const Vec3<double> p_WO{100.0 * std::cos(1.6 * i + 0.02 * k),
                                100.0 * std::sin(1.6 * i + 0.02 * k), -40.0};
        const Vec3<double> r = Vec3<double>{0.5 * k, 0.2 * k, -35.0} - p_WO;
        dynamics::Detection d = Range(k * kSecond, p_WO, Norm(r) + normal(random));
        if (drift) d.p_WO_std_m = 1.0 + 0.01 * k;
        items.push_back({i, d});
      }
    }
    const auto take = [](TargetFilter* f, const Item& item) {
      if (item.source == 0) {
        f->Detect(item.d);
      } else {
        f->Hear(Shared(item.source, item.d));
      }
    };
    auto in_time = Filter(s), at_once = Filter(s), shuffled = Filter(s);
    for (auto* f : {&in_time, &at_once, &shuffled}) (*f)->Start({5.0, 5.0, -40.0}, 50.0, 0);
    for (const Item& item : items) {
      take(in_time.get(), item);
      Step(in_time.get(), item.d.stamp);
    }
    Step(in_time.get(), 40 * kSecond);
    for (const Item& item : items) take(at_once.get(), item);
    Step(at_once.get(), 40 * kSecond);
    std::shuffle(items.begin(), items.end(), random);
    for (std::size_t n = 0; n < items.size(); ++n) {
      take(shuffled.get(), items[n]);
      take(shuffled.get(), items[n / 2]);  // a second time, because packets repeat measurements
      Step(shuffled.get(), 40 * kSecond);
    }
    const TargetBelief a = in_time->belief(), b = at_once->belief(), c = shuffled->belief();
    EXPECT_EQ(Norm(a.p_WT - b.p_WT), 0.0);
    EXPECT_EQ(a.P_WT.xx, b.P_WT.xx);
    EXPECT_EQ(Norm(a.p_WT - c.p_WT), 0.0);
    EXPECT_EQ(a.P_WT.yy, c.P_WT.yy);
    EXPECT_LT(Norm(a.p_WT - Vec3<double>{20.0, 8.0, -35.0}), 25.0);
  }
}

TEST(MeasurementFilter, OneRangeAloneLeavesARing) {
  const AgentModel s = Scenario("range");
  auto f = Filter(s);
  f->Detect(Range(0, {100.0, 0.0, -40.0}, 200.0));  // there is no cue
  Step(f.get(), 0);
  const TargetBelief b = f->belief();
  EXPECT_TRUE(b.observed);
  EXPECT_NEAR(b.p_WT.x, 100.0, 2.0);
  EXPECT_NEAR(b.p_WT.y, 0.0, 2.0);
  // A uniform density on a circle of 200 m has the variance r^2 / 2 on either axis.
  EXPECT_NEAR(b.P_WT.xx, 20000.0, 1500.0);
  EXPECT_NEAR(b.P_WT.yy, 20000.0, 1500.0);
  // A second range from another place leaves two points. A third one leaves one of them.
  f->Hear(Shared(1, Range(0, {100.0, 250.0, -40.0}, std::hypot(200.0, 250.0))));
  Step(f.get(), 0);
  f->Hear(Shared(2, Range(0, {0.0, 0.0, -40.0}, 300.0)));
  Step(f.get(), 0);
  EXPECT_LT(std::hypot(f->belief().p_WT.x - 300.0, f->belief().p_WT.y), 10.0);
}

TEST(MeasurementFilter, ANavigationErrorIsNotAveragedAway) {
  // Fifty detections come from one AUV whose position is wrong by 20 m. They cannot place the
  // target better than this.
  const AgentModel s = Scenario("position", true);
  auto f = Filter(s);
  f->Start({0.0, 0.0, -40.0}, 100.0, 0);
  for (int k = 0; k < 50; ++k) {
    dynamics::Detection d;
    d.stamp = k * kSecond;
    d.p_WO = {-100.0, 0.0, -40.0};
    d.p_WT = {20.0, 0.0, -40.0};
    d.std_m = 1.0;
    d.p_WO_std_m = 20.0;
    f->Detect(d);
    Step(f.get(), d.stamp);
  }
  const TargetBelief b = f->belief();
  EXPECT_GT(std::sqrt(b.P_WT.xx), 19.0);
  // The AUV steers in its own frame. There it knows the place better.
  EXPECT_LT(f->estimate().position_std_m(), 2.0);
  EXPECT_NEAR(f->estimate().p_WT.x, 20.0, 1.0);
}

TEST(MeasurementFilter, WhatItSharesIsItsNewestAndOneBefore) {
  const AgentModel s = Scenario("range");
  auto f = Filter(s);
  f->Start({0.0, 0.0, -40.0}, 50.0, 0);
  for (int k = 0; k < 5; ++k) {
    f->Detect(Range(k * kSecond, {0.0, 100.0, -40.0}, 100.0 + k));
    f->Hear(Shared(1, Range(k * kSecond, {100.0, 0.0, -40.0}, 99.0)));
    Step(f.get(), k * kSecond);
  }
  NeighbourState state;
  state.generation = 4 * kSecond;
  f->Tell(false, &state);
  ASSERT_EQ(state.sightings.size(), 2);
  EXPECT_EQ(state.sightings[0].stamp, 4 * kSecond);
  EXPECT_EQ(state.sightings[0].range_m, 104.0);
  EXPECT_EQ(state.sightings[1].stamp, 2 * kSecond);  // track.measurements.share_spacing_s
  EXPECT_EQ(state.sightings[1].range_m, 102.0);
  state.generation = 300 * kSecond;
  f->Tell(false, &state);
  EXPECT_FALSE(state.has_target);  // it is too old for a packet
}

TEST(MeasurementFilter, KalmanRefusesWhatItCannotUse) {
  AgentModel s = Scenario("range");
  s.track.filter = "kalman";
  EXPECT_TRUE(FindFilterConflict(s).has_value());
  s.sensing.sensor = "range_bearing";
  EXPECT_FALSE(FindFilterConflict(s).has_value());
  config::Override(&s.sensing, {"sensing.range_bearing.ambiguous=true"});
  EXPECT_TRUE(FindFilterConflict(s).has_value());
}

TEST(MeasurementFilter, AWrongImageIsGivenUpAlsoWhereThreeStandTogether) {
  // Three observers at one place pass the target, then turn towards it. Their filter begins with
  // the mirror image on the other side of their way. The first minute does not show which one is
  // true.
  const AgentModel s = Scenario("range");
  const Vec3<double> target{60.0, 100.0, -50.0};
  auto f = Filter(s);
  f->Start({60.0, -100.0, -50.0}, 10.0, 0);
  double error_m = 0.0;
  for (int k = 1; k <= 180; ++k) {
    const double t = k, x = std::min(t, 60.0), y = std::max(0.0, 0.5 * (t - 60.0));
    f->Predict(k * kSecond);
    const int source = k % 3;
    const Vec3<double> p_WO{x + 5.0 * source, y, -50.0};
    const dynamics::Detection d = Range(k * kSecond, p_WO, Norm(target - p_WO));
    if (source == 0) {
      f->Detect(d);
    } else {
      f->Hear(Shared(source, d));
    }
    f->Settle(k * kSecond, {});
    const Vec3<double> off = f->belief().p_WT - target;
    error_m = std::hypot(off.x, off.y);
    if (k == 30) {
      EXPECT_GT(error_m, 100.0) << "there is nothing to give up";
    }
  }
  EXPECT_LT(error_m, 20.0);
}

}  // namespace
}  // namespace stg::agent

#include "stg_agent/estimation/target_track.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace stg::agent {
namespace {

constexpr TimeNs kTrackStep = 100'000'000;

double Distance(const Vec3<double>& a, const Vec3<double>& b) { return Norm(a - b); }

/// Gives the track detections without noise. The target has a constant velocity.
void Follow(TargetTrack* track, int steps, const Vec3<double>& v, Vec3<double>* p, TimeNs* t) {
  for (int k = 0; k < steps; ++k) {
    *t += kTrackStep;
    *p += v * 0.1;
    track->Detect({*t, 0, *p, 0.0});
  }
}

TEST(TargetTrack, ConvergesOnNoiseFreeDetectionsWithinTenSteps) {
  for (const double speed : {0.003, 0.008, 0.02}) {
    TargetTrack track{AgentModel()};
    const Vec3<double> v = Vec3<double>{0.6, -0.64, 0.48} * speed;
    Vec3<double> p{0.3, -0.2, 0.1};
    track.Start(p + Vec3<double>{0.04, -0.05, 0.06}, 0.05, 0);
    TimeNs t = -kTrackStep;
    p += v * -0.1;
    Follow(&track, 10, v, &p, &t);
    EXPECT_LT(Distance(track.estimate().p_WT, p), 1e-4) << speed;
    EXPECT_LT(Distance(track.estimate().v_WT, v), 1e-3) << speed;
  }
}

TEST(TargetTrack, UpdateIsTheScalarKalmanFilterOfOneAxis) {
  // By hand: the prior is N(0, 0.05^2). A measurement of the same variance moves it half of the
  // way.
  AgentModel s;
  s.track.measurement_std_m = 0.05;
  TargetTrack track(s);
  track.Start({0.0, 0.0, 0.0}, 0.05, 0);
  track.Detect({0, 0, {0.02, -0.04, 0.0}, 0.01});  // this is below the floor, so 0.05 counts
  EXPECT_NEAR(track.estimate().p_WT.x, 0.01, 1e-15);
  EXPECT_NEAR(track.estimate().p_WT.y, -0.02, 1e-15);
  EXPECT_NEAR(track.estimate().pp, 0.5 * 0.0025, 1e-15);
}

TEST(TargetTrack, PredictionInOneStrideEqualsManySmallOnes) {
  TargetTrack one{AgentModel()}, many{AgentModel()};
  for (TargetTrack* t : {&one, &many}) {
    t->Start({0.1, 0.2, 0.3}, 0.05, 0);
    t->Detect({kTrackStep, 0, {0.11, 0.2, 0.3}, 0.001});
  }
  one.Predict(41 * kTrackStep);
  for (int k = 2; k <= 41; ++k) many.Predict(k * kTrackStep);
  EXPECT_NEAR(one.estimate().p_WT.x, many.estimate().p_WT.x, 1e-12);
  EXPECT_NEAR(one.estimate().pp, many.estimate().pp, 1e-12);
  EXPECT_NEAR(one.estimate().pv, many.estimate().pv, 1e-12);
  EXPECT_NEAR(one.estimate().vv, many.estimate().vv, 1e-12);
}

TEST(TargetTrack, FollowsAReflectionAtTheWallWithoutLosingAStep) {
  for (const double speed : {0.008, 0.05}) {
    TargetTrack track{AgentModel()};
    Vec3<double> p{1.0 - 20.5 * 0.1 * speed, 0.3, 0.0}, v{speed, 0.004, 0.0};
    track.Start(p, 0.01, 0);
    TimeNs t = 0;
    Follow(&track, 20, v, &p, &t);
    // The rule of the world: the target stops at the wall, and the sign of this component flips.
    p = {1.0, p.y + 0.1 * v.y, 0.0};
    v.x = -v.x;
    t += kTrackStep;
    track.Detect({t, 0, p, 0.0});
    Follow(&track, 5, v, &p, &t);
    EXPECT_LT(Distance(track.estimate().p_WT, p), 1.5e-3) << speed;
    EXPECT_LT(Distance(track.estimate().v_WT, v), 0.25 * speed) << speed;
  }
}

TEST(TargetTrack, FollowsAReversalInOpenWater) {
  for (const double speed : {0.008, 0.02, 0.05}) {
    TargetTrack track{AgentModel()};
    Vec3<double> p{0.0, 0.0, 0.0}, v{speed, 0.0, 0.0};
    track.Start(p, 0.01, 0);
    TimeNs t = 0;
    Follow(&track, 30, v, &p, &t);
    v = -v;
    Follow(&track, 15, v, &p, &t);
    EXPECT_LT(Distance(track.estimate().p_WT, p), 1e-3) << speed;
    EXPECT_LT(Distance(track.estimate().v_WT, v), 0.3 * speed) << speed;
  }
}

TEST(TargetTrack, OneOutlierIsSetAsideAndARowOfThemRestarts) {
  TargetTrack track{AgentModel()};
  Vec3<double> p{0.0, 0.0, 0.0};
  const Vec3<double> v{0.005, 0.0, 0.0};
  track.Start(p, 0.01, 0);
  TimeNs t = 0;
  Follow(&track, 20, v, &p, &t);
  t += kTrackStep;
  p += v * 0.1;
  track.Detect({t, 0, p + Vec3<double>{0.3, 0.0, 0.0}, 0.0});
  EXPECT_EQ(track.rejected_in_a_row(), 1);
  EXPECT_LT(Distance(track.estimate().p_WT, p), 1e-3);
  Follow(&track, 1, v, &p, &t);
  EXPECT_EQ(track.rejected_in_a_row(), 0);
  // The target stays at another place.
  p += Vec3<double>{0.0, 0.4, 0.0};
  Follow(&track, TargetTrack::kRestartAfter, v, &p, &t);
  EXPECT_LT(Distance(track.estimate().p_WT, p), 1e-9);
  EXPECT_LT(Distance(track.estimate().v_WT, v), 1e-9);
}

/// Mean normalised estimation error squared over many runs of a target that moves as the filter
/// assumes. It is 6 for a consistent filter. `share`: there is a second filter with its own
/// detections. The two filters tell each other their estimates every fifth step.
double MeanNees(bool share, double noise, int runs) {
  AgentModel s;
  TrackConfig& c = s.track;
  const double S = c.process_accel_std_mps2 * c.process_accel_std_mps2 * 0.1;
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  const auto draw = [&](double std) {
    return Vec3<double>{std * normal(generator), std * normal(generator), std * normal(generator)};
  };
  double sum = 0.0;
  for (int run = 0; run < runs; ++run) {
    TargetTrack track(s), other(s);
    Vec3<double> p, v = draw(c.initial_speed_std_mps);
    const Vec3<double> cue = p + draw(0.05);
    track.Start(cue, 0.05, 0);
    other.Start(cue, 0.05, 0);
    for (int k = 1; k <= 40; ++k) {
      // An exact sample of the white-acceleration process over one step.
      const double h = 0.1;
      const Vec3<double> dv = draw(std::sqrt(S * h));
      p += v * h + dv * (0.5 * h) + draw(std::sqrt(S * h * h * h / 12.0));
      v += dv;
      if (!share || k < 20) track.Detect({k * kTrackStep, 0, p + draw(noise), noise});
      other.Detect({k * kTrackStep, 0, p + draw(noise), noise});
      track.Predict(k * kTrackStep);
      if (share && k % 5 == 0) {
        const SharedEstimate mine = track.shareable();
        track.Fuse(other.shareable());
        other.Fuse(mine);
      }
    }
    const TargetEstimate& e = track.estimate();
    const Vec3<double> a = e.p_WT - p, b = e.v_WT - v;
    sum += (e.vv * Dot(a, a) - 2.0 * e.pv * Dot(a, b) + e.pp * Dot(b, b)) /
           (e.pp * e.vv - e.pv * e.pv);
  }
  return sum / runs;
}

TEST(TargetTrack, IsConsistentWithItsCovariance) {
  // The sum is chi-squared with 6 * runs degrees of freedom, so the mean has deviation sqrt(12 /
  // runs).
  const int runs = 1000;
  EXPECT_NEAR(MeanNees(false, 0.005, runs), 6.0, 4.0 * std::sqrt(12.0 / runs));
}

TEST(TargetTrack, SharingIsConservativeAlthoughEstimatesAreCorrelated) {
  EXPECT_LT(MeanNees(true, 0.005, 1000), 6.0 + 4.0 * std::sqrt(12.0 / 1000));
}

TEST(TargetTrack, ExchangingOneEstimateBackAndForthAddsNoCertainty) {
  TargetTrack a{AgentModel()}, b{AgentModel()};
  a.Start({0.1, 0.0, 0.0}, 0.05, 0);
  b.Start({0.1, 0.0, 0.0}, 0.05, 0);
  a.Detect({kTrackStep, 0, {0.1, 0.0, 0.0}, 0.01});
  const double before = a.estimate().pp;
  b.Predict(kTrackStep);
  for (int k = 1; k < 20; ++k) {
    a.Predict(k * kTrackStep);
    b.Predict(k * kTrackStep);
    b.Fuse(a.shareable());
    a.Fuse(b.shareable());
  }
  EXPECT_GE(a.estimate().pp, before * (1.0 - 1e-9));
  EXPECT_EQ(a.information_stamp(), kTrackStep) << "no newer than the one detection there was";
  EXPECT_EQ(b.information_stamp(), kTrackStep);
}

TEST(TargetTrack, ASharedEstimateIsWorthLessTheOlderItIs) {
  double previous = 0.0;
  for (const TimeNs age : {0, 1, 5, 20, 50}) {
    TargetTrack track{AgentModel()};
    track.Start({0.0, 0.0, 0.0}, 0.2, 0);
    track.Predict(100 * kTrackStep);
    track.Fuse({(100 - age) * kTrackStep, {0.05, 0.0, 0.0}, {0.01, 0.0, 0.0}, 0.002});
    EXPECT_GT(track.estimate().pp, previous);
    previous = track.estimate().pp;
    // The shared estimate moves on with its velocity. It is far better than the track's own guess.
    EXPECT_NEAR(track.estimate().p_WT.x, 0.05 + 0.001 * static_cast<double>(age), 0.01);
    EXPECT_EQ(track.estimate().stamp, 100 * kTrackStep);
  }
}

TEST(TargetTrack, ASharedEstimateFarOffReplacesOnlyAnOlderAndWorseTrack) {
  TargetTrack stale{AgentModel()}, sharp{AgentModel()};
  stale.Start({0.0, 0.0, 0.0}, 0.01, 0);
  stale.Predict(50 * kTrackStep);
  sharp.Start({0.0, 0.0, 0.0}, 0.01, 0);
  sharp.Detect({50 * kTrackStep, 0, {0.0, 0.0, 0.0}, 0.0});
  const SharedEstimate far{49 * kTrackStep, {0.7, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.002};
  stale.Fuse(far);
  sharp.Fuse(far);
  EXPECT_NEAR(stale.estimate().p_WT.x, 0.7, 1e-12);
  EXPECT_NEAR(sharp.estimate().p_WT.x, 0.0, 1e-12);
}

TEST(TargetTrack, ALateDetectionIsCarriedForwardAndCountsForLess) {
  TargetTrack on_time{AgentModel()}, late{AgentModel()};
  for (TargetTrack* t : {&on_time, &late}) {
    Vec3<double> p{0.0, 0.0, 0.0};
    TimeNs stamp = 0;
    t->Start(p, 0.01, 0);
    Follow(t, 20, {0.01, 0.0, 0.0}, &p, &stamp);
    t->Predict(30 * kTrackStep);
  }
  on_time.Detect({30 * kTrackStep, 0, {0.03, 0.0, 0.0}, 0.001});
  late.Detect({25 * kTrackStep, 0, {0.025, 0.0, 0.0}, 0.001});
  EXPECT_NEAR(late.estimate().p_WT.x, 0.03, 5e-4);
  EXPECT_GT(late.estimate().pp, on_time.estimate().pp);
  EXPECT_EQ(late.estimate().stamp, 30 * kTrackStep);
}

}  // namespace
}  // namespace stg::agent

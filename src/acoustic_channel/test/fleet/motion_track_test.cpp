#include "acoustic_channel/fleet/motion_track.hpp"

#include <gtest/gtest.h>

namespace stg::acoustics {
namespace {

constexpr TimeNs kTrackMs = 1'000'000;
constexpr MotionTrack::Options kTrackLimits{1000 * kTrackMs, 3000 * kTrackMs, true};

Motion Along(double x, double vx) { return {{x, 0.0, -5.0}, {vx, 0.0, 0.0}}; }

TEST(MotionTrack, AStraightLineIsFollowedExactlyWhateverTheStampsAreSpacedLike) {
  MotionTrack track(kTrackLimits);
  // Samples of a vehicle at 2 m/s. Their stamps jitter and are not in order.
  for (const TimeNs ms : {0, 130, 95, 310, 180, 555}) {
    ASSERT_TRUE(track.Add(ms * kTrackMs, Along(2e-3 * static_cast<double>(ms), 2.0)));
  }
  for (TimeNs ms = 0; ms <= 1500; ms += 7) {
    const auto motion = track.At(ms * kTrackMs);
    ASSERT_TRUE(motion);
    EXPECT_NEAR(motion->p_W.x, 2e-3 * static_cast<double>(ms), 1e-12) << ms;
    EXPECT_NEAR(motion->v_W.x, 2.0, 1e-12);
    EXPECT_NEAR(motion->p_W.z, -5.0, 1e-12);
  }
}

TEST(MotionTrack, NobodyIsThereBeforeTheFirstWordAndAfterALongSilence) {
  MotionTrack track(kTrackLimits);
  EXPECT_FALSE(track.At(0));
  EXPECT_FALSE(track.newest());
  track.Add(1000 * kTrackMs, Along(0.0, 1.0));
  EXPECT_FALSE(track.At(1000 * kTrackMs - 1));
  EXPECT_TRUE(track.At(4000 * kTrackMs));
  EXPECT_FALSE(track.At(4000 * kTrackMs + 1));
  track.Add(9000 * kTrackMs, Along(7.0, 1.0));
  EXPECT_TRUE(track.At(4000 * kTrackMs)) << "the gap stays where it was";
  EXPECT_FALSE(track.At(8999 * kTrackMs));
  EXPECT_TRUE(track.At(9000 * kTrackMs));
}

TEST(MotionTrack, AWordThatNobodyWaitedForDoesNotChangeThePast) {
  MotionTrack track(kTrackLimits);
  track.Add(0, Along(0.0, 1.0));
  const TimeNs t = 700 * kTrackMs;
  const double before = track.At(t)->p_W.x;
  EXPECT_NEAR(before, 0.7, 1e-12);
  // This sample comes longer than the patience after the one before. The vehicle has turned back.
  track.Add(1500 * kTrackMs, Along(-3.0, -1.0));
  EXPECT_EQ(track.At(t)->p_W.x, before);
}

TEST(MotionTrack, OfSeveralWithOneStampTheFirstCounts) {
  MotionTrack track(kTrackLimits);
  EXPECT_TRUE(track.Add(0, Along(1.0, 0.0)));
  EXPECT_FALSE(track.Add(0, Along(2.0, 0.0)));
  EXPECT_EQ(track.At(0)->p_W.x, 1.0);
}

TEST(MotionTrack, WithoutVelocitiesPositionsTellThem) {
  MotionTrack::Options limits = kTrackLimits;
  limits.has_velocity = false;
  MotionTrack track(limits);
  track.Add(0, Along(0.0, 99.0));
  EXPECT_EQ(track.At(500 * kTrackMs)->p_W.x, 0.0) << "one position moves nowhere";
  track.Add(500 * kTrackMs, Along(1.0, 99.0));
  EXPECT_NEAR(track.At(250 * kTrackMs)->v_W.x, 2.0, 1e-12);
  EXPECT_NEAR(track.At(1000 * kTrackMs)->p_W.x, 2.0, 1e-12);
  EXPECT_NEAR(track.At(1000 * kTrackMs)->v_W.x, 2.0, 1e-12);
}

TEST(MotionTrack, WhatIsForgottenIsNotNeeded) {
  MotionTrack whole(kTrackLimits), short_track(kTrackLimits);
  for (TimeNs ms = 0; ms < 2000; ms += 100) {
    const double x = static_cast<double>(ms * ms) * 1e-6;
    whole.Add(ms * kTrackMs, Along(x, 2e-3 * static_cast<double>(ms)));
    short_track.Add(ms * kTrackMs, Along(x, 2e-3 * static_cast<double>(ms)));
    short_track.ForgetBefore((ms - 150) * kTrackMs);
    for (TimeNs at = ms - 150; at < ms + 300; at += 13) {
      const auto a = whole.At(at * kTrackMs), b = short_track.At(at * kTrackMs);
      ASSERT_EQ(a.has_value(), b.has_value());
      if (a) {
        EXPECT_EQ(a->p_W.x, b->p_W.x);
      }
    }
  }
}

}  // namespace
}  // namespace stg::acoustics

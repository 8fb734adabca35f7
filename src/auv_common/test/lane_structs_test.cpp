#include "auv_common/numbers/lane_structs.hpp"

#include <gtest/gtest.h>

#include "auv_common/numbers/vector.hpp"

namespace stg {
namespace {

template <class T>
struct Sample {
  Vec3<T> place;
  T more[2] = {T(0.0), T(0.0)};
};

Sample<double> Numbered(double start) {
  return {{start, start + 1.0, start + 2.0}, {start + 3.0, start + 4.0}};
}

void ExpectEqual(const Sample<double>& a, const Sample<double>& b) {
  EXPECT_EQ(a.place.x, b.place.x);
  EXPECT_EQ(a.place.y, b.place.y);
  EXPECT_EQ(a.place.z, b.place.z);
  EXPECT_EQ(a.more[0], b.more[0]);
  EXPECT_EQ(a.more[1], b.more[1]);
}

TEST(LaneStructs, WhatIsSetInALaneIsReadThereAndNowhereElse) {
  Sample<Pack> packs;
  for (int lane = 0; lane < kLanes; ++lane) SetLaneOf(&packs, lane, Numbered(10.0 * lane));
  for (int lane = 0; lane < kLanes; ++lane) ExpectEqual(LaneOf(packs, lane), Numbered(10.0 * lane));
  EXPECT_EQ(Lane(packs.more[1], kLanes - 1), 10.0 * (kLanes - 1) + 4.0);
}

TEST(LaneStructs, KeepOthersTakesBackTheLanesOutsideTheMask) {
  Sample<Pack> before, now;
  Pack mine(0.0);
  SetLane(&mine, 0, 1.0);
  for (int lane = 0; lane < kLanes; ++lane) {
    SetLaneOf(&before, lane, Numbered(lane));
    SetLaneOf(&now, lane, Numbered(100.0 + lane));
  }
  KeepOthers(mine > Pack(0.5), before, &now);
  for (int lane = 0; lane < kLanes; ++lane) {
    ExpectEqual(LaneOf(now, lane), Numbered(lane == 0 ? 100.0 : lane));
  }
  Sample<double> one = Numbered(7.0);
  KeepOthers(true, Numbered(1.0), &one);
  ExpectEqual(one, Numbered(7.0));
  KeepOthers(false, Numbered(1.0), &one);
  ExpectEqual(one, Numbered(1.0));
}

TEST(Lanes, PerLaneHoldsOneValueForEachLane) {
  PerLane<Pack, int> many{};
  EXPECT_EQ(static_cast<int>(many.size()), kLanesOf<Pack>);
  many.back() = 5;
  EXPECT_EQ(OfLane(many, kLanes - 1), 5);
  const PerLane<double, int> one = 3;
  EXPECT_EQ(OfLane(one, 0), 3);
  EXPECT_EQ(kLanesOf<double>, 1);
}

}  // namespace
}  // namespace stg

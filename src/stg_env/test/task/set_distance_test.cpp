#include "set_distance.hpp"

#include <gtest/gtest.h>

#include <vector>

/// Distances of sets, computed by hand.
namespace stg::task {
namespace {

SetDistance Of(const std::vector<Vec3<double>>& a, const std::vector<Vec3<double>>& b) {
  return DistanceOfSets(a.data(), static_cast<int>(a.size()), b.data(), static_cast<int>(b.size()),
                        100.0);
}

TEST(SetDistance, EqualSetsInAnyOrderAreNotApart) {
  const SetDistance d = Of({{0, 0, 0}, {500, 0, 0}}, {{500, 0, -40}, {0, 0, 0}});
  EXPECT_EQ(d.ospa_m, 0.0);
  EXPECT_EQ(d.gospa_m, 0.0);
  EXPECT_EQ(Of({}, {}).ospa_m, 0.0);
}

TEST(SetDistance, IsTheMeanOrTheSumOfTheCheapestPairs) {
  // The cheapest pairs are 30 and 40 apart, the other two pairs 70 and 140.
  const SetDistance d = Of({{30, 0, 0}, {140, 0, 0}}, {{100, 0, 0}, {0, 0, 0}});
  EXPECT_DOUBLE_EQ(d.ospa_m, 35.0);
  EXPECT_DOUBLE_EQ(d.gospa_m, 70.0);
}

TEST(SetDistance, WhatIsMissedCostsTheCutoffOrHalfOfIt) {
  // One of three targets is known, with an error of 12.
  const SetDistance d = Of({{0, 12, 0}}, {{0, 0, 0}, {900, 0, 0}, {0, 900, 0}});
  EXPECT_DOUBLE_EQ(d.ospa_m, (12.0 + 2.0 * 100.0) / 3.0);
  EXPECT_DOUBLE_EQ(d.gospa_m, 12.0 + 2.0 * 50.0);
  const SetDistance none = Of({}, {{0, 0, 0}, {1, 0, 0}});
  EXPECT_DOUBLE_EQ(none.ospa_m, 100.0);
  EXPECT_DOUBLE_EQ(none.gospa_m, 100.0);
  // A false estimate costs as much as a missed target.
  EXPECT_DOUBLE_EQ(Of({{0, 0, 0}, {700, 0, 0}}, {{0, 0, 0}}).gospa_m, 50.0);
}

TEST(SetDistance, BeyondTheCutoffAPairIsAMissAndAFalseOne) {
  const SetDistance d = Of({{500, 0, 0}}, {{0, 0, 0}});
  EXPECT_DOUBLE_EQ(d.ospa_m, 100.0);
  EXPECT_DOUBLE_EQ(d.gospa_m, 100.0);
}

}  // namespace
}  // namespace stg::task

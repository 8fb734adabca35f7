// A node must refuse numbers from outside that it cannot use, and take the others.

#include "auv_dynamics/nodes/conversions.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace stg::dynamics {
namespace {

nav_msgs::Odometry AtRest() {
  nav_msgs::Odometry m;
  m.pose.pose.orientation.w = 1.0;
  return m;
}

TEST(FiniteOdometry, TakesOrdinaryNumbersAndThoseOnTheBound) {
  nav_msgs::Odometry m = AtRest();
  EXPECT_TRUE(nodes::FiniteOdometry(m));
  m.pose.pose.position.x = -1e6;
  m.twist.twist.angular.z = 1e6;
  EXPECT_TRUE(nodes::FiniteOdometry(m));
}

TEST(FiniteOdometry, RefusesNanInfinityAndHugeNumbersInEveryPart) {
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                        -std::numeric_limits<double>::infinity(), 1e300, -1.001e6};
  for (const double x : bad) {
    nav_msgs::Odometry m = AtRest();
    m.pose.pose.position.y = x;
    EXPECT_FALSE(nodes::FiniteOdometry(m)) << x;
    m = AtRest();
    m.twist.twist.linear.z = x;
    EXPECT_FALSE(nodes::FiniteOdometry(m)) << x;
    m = AtRest();
    m.twist.twist.angular.x = x;
    EXPECT_FALSE(nodes::FiniteOdometry(m)) << x;
    m = AtRest();
    m.pose.pose.orientation.w = x;
    EXPECT_FALSE(nodes::FiniteOdometry(m)) << x;
  }
}

TEST(FinitePose, RefusesAQuaternionThatIsNoRotation) {
  geometry_msgs::Pose pose;
  EXPECT_FALSE(nodes::FinitePose(pose)) << "all zero";
  pose.orientation.w = 0.6;
  pose.orientation.z = -0.8;
  EXPECT_TRUE(nodes::FinitePose(pose));
  pose.orientation.z = -0.802;
  EXPECT_FALSE(nodes::FinitePose(pose));
}

TEST(UsableDetection, TakesWhatASensorOfTheLongestRangeTells) {
  Detection d;
  d.kind = MeasurementKind::kRange;
  // A range says nothing about the direction, so the target may be anywhere around.
  d.range_m = d.std_m = 1e5;
  d.range_std_m = 1e4;
  auv_msgs::TargetDetection m;
  nodes::SetDetection(d, &m);
  EXPECT_TRUE(nodes::UsableDetection(m)) << m.variance.x;
  EXPECT_EQ(nodes::DetectionOf(m).std_m, d.std_m);
}

TEST(UsableDetection, RefusesVariancesThatAreNoneOrOfImpossibleDeviations) {
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), -1.0, 1.001e12, 1e300}) {
    auv_msgs::TargetDetection m;
    nodes::SetDetection({}, &m);
    ASSERT_TRUE(nodes::UsableDetection(m));
    m.variance.x = x;
    EXPECT_FALSE(nodes::UsableDetection(m)) << x;
  }
}

}  // namespace
}  // namespace stg::dynamics

#include "auv_common/numbers/lanes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace stg {
namespace {

const std::vector<double> kAngles = {0.0,   -0.1, 0.7,   1.2,    -3.0, 30.0, 61.9,
                                     -62.1, 70.0, 3.9e3, -5.7e6, 1e12, 1e300};

TEST(Lanes, SineAndCosineOfALaneDoNotDependOnTheOthers) {
  for (const double angle : kAngles) {
    double sine, cosine;
    SinCos(angle, &sine, &cosine);
    for (const double other : kAngles) {
      Pack packed(other), s, c;
      SetLane(&packed, kLanes - 1, angle);
      SinCos(packed, &s, &c);
      EXPECT_EQ(Lane(s, kLanes - 1), sine) << angle << " beside " << other;
      EXPECT_EQ(Lane(c, kLanes - 1), cosine) << angle << " beside " << other;
    }
  }
}

TEST(Lanes, SineAndCosineAreRightUpToAMillionTurns) {
  for (const double angle : kAngles) {
    if (std::abs(angle) > 6e6) continue;
    double sine, cosine;
    SinCos(angle, &sine, &cosine);
    EXPECT_NEAR(sine, std::sin(angle), 3e-16) << angle;
    EXPECT_NEAR(cosine, std::cos(angle), 3e-16) << angle;
  }
}

/// GCC may fuse the products of a rotation. Volatile keeps it from computing them
/// in advance.
void Rotate(const double* in, double* out) {
  out[0] = in[0] * in[2] - in[1] * in[3];
  out[1] = in[1] * in[2] + in[0] * in[3];
}

TEST(Lanes, ARotationRoundsEachProduct) {
  // 1 + 2^-30 squared is 1 + 2^-29 + 2^-60, and a double has no room for the last part.
  const double a = 1.0 + std::ldexp(1.0, -30);
  const double rounded = 1.0 + std::ldexp(1.0, -29);
  volatile double values[4] = {a, rounded, a, 1.0};
  const double in[4] = {values[0], values[1], values[2], values[3]};
  double out[2];
  Rotate(in, out);
  EXPECT_EQ(out[0], 0.0) << "a fused product would leave 2^-60";
}

}  // namespace
}  // namespace stg

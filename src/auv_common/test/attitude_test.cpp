#include "auv_common/numbers/attitude.hpp"

#include <gtest/gtest.h>

#include <random>

namespace stg {
namespace {

Vec3<double> RandomVector(std::mt19937_64* random, double largest) {
  std::uniform_real_distribution<double> uniform(-largest, largest);
  const double x = uniform(*random), y = uniform(*random), z = uniform(*random);
  return {x, y, z};
}

double Difference(const Mat3<double>& a, const Mat3<double>& b) {
  double most = 0.0;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a.m[r][c] - b.m[r][c]));
  }
  return most;
}

Mat3<double> RotationOfRpy(const Vec3<double>& rpy) { return RotationOf(TrigOf(rpy)); }

Mat3<double> RotationThroughQuaternion(const Vec3<double>& rpy) {
  double q[4];
  QuaternionOf(rpy, &q);
  return RotationOf(q);
}

TEST(Attitude, WrapAngleLiesInHalfOpenIntervalAndDiffersByWholeTurns) {
  EXPECT_DOUBLE_EQ(WrapAngle(kPi), -kPi);
  EXPECT_DOUBLE_EQ(WrapAngle(-kPi), -kPi);
  EXPECT_DOUBLE_EQ(WrapAngle(0.5), 0.5);
  EXPECT_NEAR(WrapAngle(3.5), 3.5 - 2.0 * kPi, 1e-15);
  for (double a = -20.0; a < 20.0; a += 0.0137) {
    const double wrapped = WrapAngle(a);
    EXPECT_GE(wrapped, -kPi);
    EXPECT_LT(wrapped, kPi);
    EXPECT_NEAR(std::remainder(wrapped - a, 2.0 * kPi), 0.0, 1e-13);
  }
}

TEST(Attitude, AxesFollowForwardLeftUp) {
  const Vec3<double> bow{1.0, 0.0, 0.0}, left{0.0, 1.0, 0.0};
  // Positive yaw turns the bow to the left, seen from above.
  EXPECT_NEAR((RotationOfRpy({0.0, 0.0, kPi / 2}) * bow).y, 1.0, 1e-15);
  // Positive pitch lowers the bow, as y points left.
  EXPECT_NEAR((RotationOfRpy({0.0, 0.3, 0.0}) * bow).z, -std::sin(0.3), 1e-15);
  // Positive roll raises the left side.
  EXPECT_NEAR((RotationOfRpy({0.3, 0.0, 0.0}) * left).z, std::sin(0.3), 1e-15);
}

TEST(Attitude, RotationIsTheProductOfYawPitchRoll) {
  const Vec3<double> rpy{0.4, -0.7, 2.1};
  const Mat3<double> roll = RotationOfRpy({rpy.x, 0.0, 0.0});
  const Mat3<double> pitch = RotationOfRpy({0.0, rpy.y, 0.0});
  const Mat3<double> yaw = RotationOfRpy({0.0, 0.0, rpy.z});
  const Vec3<double> a{0.3, -1.1, 0.8};
  const Vec3<double> expected = yaw * (pitch * (roll * a));
  EXPECT_NEAR(Norm(RotationOfRpy(rpy) * a - expected), 0.0, 1e-15);
}

TEST(Attitude, RollPitchYawQuaternionAndMatrixRoundTrip) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> turn(-kPi, kPi), pitch(-1.55, 1.55);
  for (int n = 0; n < 2000; ++n) {
    const Vec3<double> rpy{turn(random), pitch(random), turn(random)};
    double q[4];
    QuaternionOf(rpy, &q);
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1.0, 1e-14);
    EXPECT_GE(q[0], 0.0);
    EXPECT_LT(Difference(RotationOf(q), RotationOfRpy(rpy)), 1e-14);
    const Vec3<double> back = RpyOf(TrigOf(RotationOf(q)));
    EXPECT_NEAR(Norm(back - rpy), 0.0, 1e-11);
  }
}

TEST(Attitude, RotationTransposeIsItsInverse) {
  std::mt19937_64 random(2);
  for (int n = 0; n < 200; ++n) {
    const Mat3<double> R = RotationOfRpy(RandomVector(&random, 3.0));
    const Vec3<double> a = RandomVector(&random, 1.0);
    EXPECT_NEAR(Norm(R.TransposeTimes(R * a) - a), 0.0, 1e-15);
  }
}

TEST(Attitude, RoundTripSurvivesPitch90) {
  // At the vertical, roll and yaw are not unique, but the rotation is.
  for (const double pitch : {kPi / 2, -kPi / 2}) {
    for (const double off : {0.0, 1e-12, -1e-10, 1e-8, 1e-5, -1e-3}) {
      for (const double roll : {-2.0, 0.0, 0.4}) {
        for (const double yaw : {-3.0, 0.0, 1.3}) {
          const Vec3<double> rpy{roll, pitch + off, yaw};
          const Mat3<double> R = RotationThroughQuaternion(rpy);
          EXPECT_LT(Difference(R, RotationOfRpy(rpy)), 1e-14);
          const EulerTrig<double> trig = TrigOf(R);
          EXPECT_LT(Difference(R, RotationOf(trig)), 1e-7) << pitch + off << " " << roll;
          const Vec3<double> back = RpyOf(trig);
          ASSERT_TRUE(std::isfinite(back.x) && std::isfinite(back.y) && std::isfinite(back.z));
          EXPECT_LT(Difference(R, RotationThroughQuaternion(back)), 1e-7);
        }
      }
    }
  }
}

TEST(Attitude, EulerRatesTurnTheMatrixAsBodyRatesDo) {
  // R_dot = R_WB S(w), with R_dot by central differences along the Euler rates.
  std::mt19937_64 random(3);
  for (int n = 0; n < 200; ++n) {
    const Vec3<double> rpy = RandomVector(&random, 1.4), w = RandomVector(&random, 1.0);
    const Vec3<double> rates = EulerRates(TrigOf(rpy), w);
    const double h = 1e-6;
    const Mat3<double> after = RotationOfRpy(rpy + rates * h);
    const Mat3<double> before = RotationOfRpy(rpy - rates * h);
    const Mat3<double> R = RotationOfRpy(rpy);
    for (const Vec3<double>& a :
         {Vec3<double>{1, 0, 0}, Vec3<double>{0, 1, 0}, Vec3<double>{0, 0, 1}}) {
      const Vec3<double> slope = (after * a - before * a) * (0.5 / h);
      EXPECT_NEAR(Norm(slope - R * Cross(w, a)), 0.0, 1e-7);
    }
  }
}

TEST(Attitude, EulerRatesStayFiniteAtPitch90) {
  for (const double pitch : {kPi / 2, -kPi / 2}) {
    EulerTrig<double> trig = TrigOf(Vec3<double>{0.3, pitch, 0.1});
    for (const double cosine : {0.0, 1e-300, -1e-300, trig.cos_theta}) {
      trig.cos_theta = cosine;
      const Vec3<double> rates = EulerRates(trig, Vec3<double>{1.0, -1.0, 1.0});
      EXPECT_TRUE(std::isfinite(rates.x) && std::isfinite(rates.y) && std::isfinite(rates.z));
    }
  }
}

TEST(Attitude, PacksAndScalarsRoundAlike) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> angle(-2.0 * kPi, 2.0 * kPi), small(-1.0, 1.0);
  for (int n = 0; n < 5000; ++n) {
    alignas(64) double a[kLanes], b[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      // Lanes with numbers of very different size need different branches of one evaluation.
      a[l] = angle(random) * (n % 3 == 0 && l % 2 == 0 ? 1e-3 : 1.0);
      b[l] = small(random);
    }
    const Pack x = Pack::load_unaligned(a), y = Pack::load_unaligned(b);
    Pack sine, cosine;
    SinCos(x, &sine, &cosine);
    const Pack e = Exp(x), atan2 = Atan2(y, x), log1p = Log1p(Abs(y)), wrapped = WrapAngle(x);
    for (int l = 0; l < kLanes; ++l) {
      double s, c;
      SinCos(a[l], &s, &c);
      EXPECT_EQ(Lane(sine, l), s);
      EXPECT_EQ(Lane(cosine, l), c);
      EXPECT_NEAR(s, std::sin(a[l]), 1e-15);
      EXPECT_NEAR(c, std::cos(a[l]), 1e-15);
      EXPECT_EQ(Lane(e, l), Exp(a[l]));
      EXPECT_EQ(Lane(atan2, l), Atan2(b[l], a[l]));
      EXPECT_EQ(Lane(log1p, l), Log1p(std::abs(b[l])));
      EXPECT_EQ(Lane(wrapped, l), WrapAngle(a[l]));
    }
  }
}

}  // namespace
}  // namespace stg

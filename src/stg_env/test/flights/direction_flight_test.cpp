// Directions that the modems of AUVs measure: their errors, their axes, and whole flights.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "auv_common/error.hpp"
#include "auv_common/numbers/attitude.hpp"
#include "env/env_fixture.hpp"
#include "stg_agent/stations/station_channel.hpp"
#include "stg_env/env/evaluation.hpp"

namespace stg::env {
namespace {

using acoustics::Reception;

constexpr double kRadPerDeg = kPi / 180.0;
constexpr TimeNs kStep = 1'000'000'000;

/// Two AUVs that move without turning, and one beacon.
class Directions : public ::testing::Test {
 protected:
  void Make(double usbl_std_deg, const std::string& by = "one_way") {
    scenario_ = Shipped("deep", "usbl_auvs",
                        {"agents=2", "stations.survey_std_m=1e-9", "localization.ranges.by=" + by,
                         "localization.ranges.usbl_std_deg=" + std::to_string(usbl_std_deg)});
    channel_ = agent::MakeStationChannel(scenario_.model(), scenario_.channel,
                                         scenario_.world.sensing, {});
    channel_->Reset(7, 0);
  }

  Vec3<double> At(int i, double t) const {
    return i == 2 ? Vec3<double>{1500.0, 1500.0, -100.0} : start_W_[i] + v_W_[i] * t;
  }

  /// All that AUV 0 receives in some time.
  std::vector<Reception> Run(double seconds) {
    std::vector<Reception> all;
    const std::vector<Vec3<double>> v_W{v_W_[0], v_W_[1]};
    const std::vector<std::uint8_t> bytes(32, 1);
    for (std::uint32_t step = 0; Seconds(step * kStep) < seconds; ++step) {
      const TimeNs t = step * kStep;
      std::vector<acoustics::Transmission> offered(2);
      for (int i = 0; i < 2; ++i) {
        acoustics::Transmission& packet = offered[static_cast<std::size_t>(i)];
        packet.source = i;
        packet.stamp = packet.generation = t;
        packet.payload = acoustics::ViewOf(bytes);
      }
      channel_->SetAttitudes({R_WB_, R_WB_});
      channel_->Step(t, step, {At(0, Seconds(t)), At(1, Seconds(t))}, v_W, offered);
      channel_->Deliver(0, t + kStep, &all);
      std::vector<Reception> others;
      channel_->Deliver(1, t + kStep, &others);
    }
    return all;
  }

  Scenario scenario_;
  std::unique_ptr<acoustics::Channel> channel_;
  Vec3<double> start_W_[2] = {{-300.0, 200.0, -20.0}, {-200.0, 260.0, -60.0}};
  Vec3<double> v_W_[2] = {{0.5, -0.5, 0.0}, {-1.0, 0.25, 0.1}};
  Mat3<double> R_WB_ = RotationOf(TrigOf(Vec3<double>{0.1, -0.2, 2.0}));
};

// Turned back into the world, each direction is that between both places at transmission; of an
// answer to a ping, between both in the middle of the round trip.
TEST_F(Directions, AreInBodyAxes) {
  for (const char* by : {"one_way", "ping"}) {
    Make(1e-5, by);
    ASSERT_TRUE(channel_->measures_directions());
    int of_beacon = 0, of_answers = 0;
    for (const Reception& r : Run(240.0)) {
      ASSERT_TRUE(r.has_direction);
      const bool answer = r.payload.size == 0;
      const double c = std::cos(r.elevation_rad), t = Seconds(answer ? r.generation : r.transmit);
      const Vec3<double> line =
          R_WB_ * Vec3<double>{c * std::cos(r.azimuth_rad), c * std::sin(r.azimuth_rad),
                               std::sin(r.elevation_rad)};
      const Vec3<double> way = At(r.source, t) - At(0, t);
      EXPECT_NEAR(Norm(line - way * (1.0 / Norm(way))), 0.0, 1e-6);
      of_beacon += r.source == 2 ? 1 : 0;
      of_answers += answer ? 1 : 0;
    }
    EXPECT_GT(of_beacon, 3);
    EXPECT_EQ(of_answers > 3, std::string(by) == "ping");
  }
}

// The deviation is that of the key, in both directions across the line of sight: the azimuth of a
// sender above or below has a larger one.
TEST_F(Directions, HaveTheErrorOfTheKey) {
  constexpr double kStd_deg = 1.0;
  Make(kStd_deg);
  v_W_[0] = v_W_[1] = {};
  start_W_[1] = start_W_[0] + Vec3<double>{100.0, 0.0, -100.0};
  R_WB_ = RotationOf(TrigOf(Vec3<double>()));
  double azimuth = 0.0, elevation = 0.0, port = 0.0, up = 0.0;
  int count = 0;
  for (const Reception& r : Run(10000.0)) {
    if (r.source != 1) continue;
    ++count;
    azimuth += r.azimuth_rad;
    elevation += r.elevation_rad + 0.25 * kPi;
    port += r.azimuth_rad * r.azimuth_rad;
    up += (r.elevation_rad + 0.25 * kPi) * (r.elevation_rad + 0.25 * kPi);
  }
  ASSERT_GT(count, 800);
  const double std_rad = kStd_deg * kRadPerDeg, share = 4.0 / std::sqrt(count);
  EXPECT_NEAR(azimuth / count, 0.0, share * std::sqrt(2.0) * std_rad);
  EXPECT_NEAR(elevation / count, 0.0, share * std_rad);
  EXPECT_NEAR(std::sqrt(port / count), std::sqrt(2.0) * std_rad, share * std_rad);
  EXPECT_NEAR(std::sqrt(up / count), std_rad, share * std_rad);
}

TEST_F(Directions, AreNotThereByDefault) {
  Make(0.0);
  EXPECT_FALSE(channel_->measures_directions());
  for (const Reception& r : Run(30.0)) EXPECT_FALSE(r.has_direction);
}

task::MetricSummary FlyWithHeads(const std::string& condition, const std::vector<std::string>& keys,
                                 int flights = 8) {
  Scenario s = Short(Shipped("deep", condition, keys), 900);
  s.run.time.tail_steps = 300;
  const auto all = Evaluate(EnvFactory(s), agent::MakeDecider("encircle", s.model()),
                            {flights, 500, kMixBlock}, nullptr);
  task::MetricSummary m = task::Summarise(all);
  std::printf("%-12s position %.1f m, NEES %.2f; relative %.2f m\n", condition.c_str(),
              m.Mean("navigation_rmse_tail"), m.Mean("navigation_nees"), m.Mean("relative_rmse"));
  return m;
}

/// 70 % of the packets are lost by bursts of noise.
const std::vector<std::string> kLossy{"channel.physical.noise.burst_db=100",
                                      "channel.physical.noise.burst_every_s=5.2",
                                      "channel.physical.noise.burst_length_s=12.0"};

// The NEES of positions is 2 if the stated error is right, and more if it is too small. The AUVs of
// a flight share most of their error, so it scatters much.
TEST(DirectionFlight, OneBeaconAndHeadsPlaceTheSwarmAndStateTheError) {
  constexpr int kManyFlights = 24;
  const task::MetricSummary ranges =
      FlyWithHeads("usbl_auvs", {"localization.ranges.usbl_std_deg=0.0"}, kManyFlights);
  const task::MetricSummary both = FlyWithHeads("usbl_auvs", {}, kManyFlights);
  EXPECT_LT(both.Mean("navigation_rmse_tail"), ranges.Mean("navigation_rmse_tail"));
  EXPECT_LT(both.Mean("relative_rmse"), ranges.Mean("relative_rmse"));
  EXPECT_LT(both.Mean("navigation_nees"), 3.0);
  const task::MetricSummary lossy = FlyWithHeads("usbl_auvs", kLossy, kManyFlights);
  EXPECT_LT(lossy.Mean("navigation_nees"), 3.0);
}

// The heads are the best ones, and the compasses are wrong by a degree: the filter must not take
// its bearings for as good as its heads.
TEST(DirectionFlight, AWrongCompassIsNotTakenForARightOne) {
  const task::MetricSummary m = FlyWithHeads(
      "usbl_auvs",
      {"localization.ranges.usbl_std_deg=0.1", "navigation.dead_reckoning.heading_std_deg=1.0"},
      24);
  EXPECT_LT(m.Mean("navigation_nees"), 3.5);
}

}  // namespace
}  // namespace stg::env

// The packet of measurements keeps its numbers within the stated resolutions.

#include "stg_agent/packet/measurement_packet.hpp"

#include <gtest/gtest.h>

#include <random>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_common/numbers/attitude.hpp"
#include "estimation/fleet.hpp"

namespace stg::agent {
namespace {

constexpr TimeNs kSecond = 1'000'000'000;

AgentModel Scenario(const std::string& sensor, bool ambiguous = false) {
  FleetOptions o;
  o.sensor = sensor;
  o.observers = 4;
  AgentScenario s = FleetScenario(o);
  if (ambiguous) config::Override(&s, {"sensing." + sensor + ".ambiguous=true"});
  return s.model();
}

class MeasurementPackets : public ::testing::TestWithParam<std::tuple<const char*, bool>> {
 protected:
  MeasurementPackets()
      : s_(Scenario(std::get<0>(GetParam()), std::get<1>(GetParam()))), codec_(s_) {}

  double Draw(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random_);
  }
  Vec3<double> Vector(double limit) {
    const double x = Draw(-limit, limit), y = Draw(-limit, limit);
    return {x, y, Draw(-limit, limit)};
  }

  /// A state with measurements as an AUV makes them.
  NeighbourState Random() {
    NeighbourState n;
    n.source = static_cast<int>(Draw(0.0, 4.0));
    n.generation = static_cast<TimeNs>(Draw(70.0, 3000.0)) * kSecond;
    n.p_W = Vector(2400.0);
    n.v_W = Vector(1.0);
    n.confidence = Draw(0.0, 1.0);
    n.tracking_error = Draw(0.0, 500.0);
    n.phase = static_cast<int>(Draw(0.0, 4.0));
    n.link_quality = Draw(0.0, 1.0);
    n.position_std_m = Draw(0.5, 50.0);
    n.has_target = true;
    World();
    for (int k = 0; k < (std::get<1>(GetParam()) ? 1 : 2); ++k) {
      dynamics::Detection& d = n.sightings.push_back({});
      d.kind = kind_;
      d.stamp = n.generation - static_cast<TimeNs>(Draw(0.0, 60.0)) * kSecond;
      d.ambiguous = std::get<1>(GetParam());
      d.p_WO = n.p_W + Vec3<double>{Draw(-100.0, 100.0), Draw(-100.0, 100.0), Draw(-20.0, 20.0)};
      d.range_m = Draw(0.0, 600.0);
      d.azimuth_rad = Draw(-kPi, kPi);
      d.elevation_rad = Draw(-1.5, 1.5);
      d.mirror_azimuth_rad = Draw(-kPi, kPi);
      const bool point = kind_ == dynamics::MeasurementKind::kPosition ||
                         kind_ == dynamics::MeasurementKind::kRangeBearing;
      d.p_WT = point ? Vector(2400.0) : d.p_WO;
    }
    return n;
  }
  void World() { kind_ = dynamics::TargetSensors().Make(s_.sensing.sensor, s_.sensing)->kind(); }

  std::mt19937_64 random_{5};
  AgentModel s_;
  MeasurementPacket codec_;
  dynamics::MeasurementKind kind_ = dynamics::MeasurementKind::kPosition;
};

TEST_P(MeasurementPackets, ComeOutWithinTheirResolution) {
  for (int trial = 0; trial < 500; ++trial) {
    const NeighbourState in = Random();
    const Packet packet = codec_.Encode(in);
    const TimeNs arrival = in.generation + static_cast<TimeNs>(Draw(0.0, 200.0) * 1e9);
    const NeighbourState out = codec_.Decode(packet.data(), packet.size(), arrival);
    EXPECT_EQ(out.source, in.source);
    EXPECT_EQ(out.generation, in.generation);
    EXPECT_EQ(out.phase, in.phase);
    EXPECT_FALSE(out.saturated);
    EXPECT_NEAR(out.p_W.x, in.p_W.x, codec_.position_error_m() + 1e-9);
    EXPECT_NEAR(out.p_W.z, in.p_W.z, codec_.position_error_m() + 1e-9);
    EXPECT_NEAR(out.v_W.y, in.v_W.y, 0.02);
    EXPECT_NEAR(out.confidence, in.confidence, 0.034);
    EXPECT_NEAR(out.tracking_error, in.tracking_error, 0.05 * in.tracking_error + 0.2);
    // A deviation is never rounded down.
    EXPECT_GE(out.position_std_m, in.position_std_m * (1.0 - 1e-6));
    EXPECT_LE(out.position_std_m, 1.25 * in.position_std_m);
    ASSERT_EQ(out.sightings.size(), in.sightings.size());
    for (int k = 0; k < in.sightings.size(); ++k) {
      const dynamics::Detection &a = in.sightings[k], &b = out.sightings[k];
      EXPECT_EQ(a.stamp, b.stamp);
      EXPECT_EQ(b.kind, kind_);
      const bool ambiguous = std::get<1>(GetParam());
      const bool point = !ambiguous && (kind_ == dynamics::MeasurementKind::kPosition ||
                                        kind_ == dynamics::MeasurementKind::kRangeBearing);
      if (point) {
        EXPECT_LT(Norm(b.p_WT - a.p_WT), 1.74 * codec_.position_error_m());
        continue;
      }
      EXPECT_NEAR(b.p_WO.x, a.p_WO.x, codec_.position_error_m() + codec_.offset_error_m() + 1e-9);
      if (kind_ != dynamics::MeasurementKind::kBearing) {
        EXPECT_NEAR(b.range_m, a.range_m, codec_.range_error_m() + 1e-9);
        EXPECT_NEAR(b.range_std_m, 1.0 + 0.01 * b.range_m, 1e-12);
      }
      if (kind_ != dynamics::MeasurementKind::kRange) {
        EXPECT_NEAR(WrapAngle(b.azimuth_rad - a.azimuth_rad), 0.0,
                    codec_.azimuth_error_rad() + 1e-9);
        EXPECT_NEAR(b.elevation_rad, a.elevation_rad, codec_.elevation_error_rad() + 1e-9);
      }
      if (ambiguous) {
        EXPECT_TRUE(b.ambiguous);
        EXPECT_NEAR(WrapAngle(b.mirror_azimuth_rad - a.mirror_azimuth_rad), 0.0, 4e-4);
      }
    }
  }
}

TEST_P(MeasurementPackets, DamageIsRefused) {
  const NeighbourState in = Random();
  const Packet packet = codec_.Encode(in);
  for (int bit = 0; bit < 8 * kPacketBytes; ++bit) {
    Packet damaged = packet;
    damaged[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_THROW(codec_.Decode(damaged.data(), damaged.size(), in.generation), UserError) << bit;
  }
  EXPECT_THROW(codec_.Decode(packet.data(), packet.size() - 1, in.generation), UserError);
}

TEST_P(MeasurementPackets, OfTheOtherLayoutAreRefused) {
  const PacketCodec estimates(s_), measurements(s_, PacketLayout::kMeasurements);
  NeighbourState in = Random();
  in.has_target = false;
  in.sightings.clear();
  const Packet a = estimates.Encode(in), b = measurements.Encode(in);
  EXPECT_THROW(measurements.Decode(a.data(), a.size(), in.generation), UserError);
  EXPECT_THROW(estimates.Decode(b.data(), b.size(), in.generation), UserError);
  const NeighbourState out = measurements.Decode(b.data(), b.size(), in.generation);
  EXPECT_FALSE(out.has_target);
}

INSTANTIATE_TEST_SUITE_P(
    Packet, MeasurementPackets,
    ::testing::Values(std::make_tuple("position", false), std::make_tuple("range", false),
                      std::make_tuple("bearing", false), std::make_tuple("range_bearing", false),
                      std::make_tuple("bearing", true), std::make_tuple("range_bearing", true)));

TEST(MeasurementPacket, ValuesOutOfRangeSaturateAndSaySo) {
  const AgentModel s = Scenario("range");
  const MeasurementPacket codec(s);
  NeighbourState in;
  in.generation = 100 * kSecond;
  in.p_W = {1e5, 0.0, 0.0};
  const Packet packet = codec.Encode(in);
  const NeighbourState out = codec.Decode(packet.data(), packet.size(), in.generation);
  EXPECT_TRUE(out.saturated);
  EXPECT_EQ(out.p_W.x, 2500.0);
  in.p_W.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(codec.Encode(in), std::invalid_argument);
}

TEST(MeasurementPacket, APacketFromBeforeTheStartIsRefused) {
  const AgentModel s = Scenario("range");
  const MeasurementPacket codec(s);
  NeighbourState in;
  in.generation = 10 * kSecond;
  const Packet packet = codec.Encode(in);
  EXPECT_THROW(codec.Decode(packet.data(), packet.size(), 9 * kSecond), UserError);
}

}  // namespace
}  // namespace stg::agent

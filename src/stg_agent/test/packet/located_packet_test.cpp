// Version 5 of the packet: reckoned positions outside of the region, whether the log has bottom,
// and two ranges in the place of the second measurement.

#include <gtest/gtest.h>

#include "auv_common/error.hpp"
#include "stg_agent/packet/packet.hpp"

namespace stg::agent {
namespace {

AgentModel Model(const std::string& localization) {
  AgentScenario s;
  s.run.agents = 4;
  s.world.workspace.half_extent_m = 2000.0;
  s.world.sensing.sensor = "range";
  s.world.sensing.range_m = 600.0;
  s.agent.track.filter = "measurements";
  s.agent.localization.kind = localization;
  s.agent.stations.crafts = {{0.0, 0.0}};
  return s.model();
}

NeighbourState Example() {
  NeighbourState s;
  s.source = 2;
  s.generation = 50'000'000'000;
  s.p_W = {3100.0, -2700.0, -40.0};  // the current has carried it out of the region
  s.v_W = {0.5, 0.25, 0.0};
  s.position_std_m = 800.0;
  s.adrift = true;
  s.ranges.push_back({4, 49'900'000'000, 312.5});
  s.ranges.push_back({1, 49'000'000'000, -1.5});
  return s;
}

TEST(LocatedPacket, PositionsMayLeaveTheRegion) {
  const AgentModel model = Model("ranges");
  const PacketCodec codec(model, PacketLayout::kMeasurements);
  const NeighbourState s = Example();
  const Packet packet = codec.Encode(s);
  EXPECT_EQ(PacketCodec::SourceOf(packet.data(), packet.size()), 2);
  const NeighbourState sent =
      codec.Decode(packet.data(), packet.size(), s.generation, {2500.0, -2000.0, 0.0});
  EXPECT_NEAR(sent.p_W.x, s.p_W.x, 0.08);
  EXPECT_NEAR(sent.p_W.y, s.p_W.y, 0.08);
  EXPECT_NEAR(sent.p_W.z, s.p_W.z, 0.08);
  EXPECT_FALSE(sent.saturated);
  EXPECT_TRUE(sent.adrift);
  EXPECT_GE(sent.position_std_m, s.position_std_m);
  EXPECT_LT(sent.position_std_m, 1.5 * s.position_std_m);
}

TEST(LocatedPacket, CarriesTwoRangesBesideASighting) {
  const AgentModel model = Model("ranges");
  const PacketCodec codec(model, PacketLayout::kMeasurements);
  NeighbourState s = Example();
  dynamics::Detection d;
  d.kind = dynamics::MeasurementKind::kRange;
  d.stamp = 48'000'000'000;
  d.p_WO = s.p_W;
  d.range_m = 90.0;
  s.has_target = true;
  s.sightings.push_back(d);
  const Packet packet = codec.Encode(s);
  const NeighbourState sent = codec.Decode(packet.data(), packet.size(), s.generation, s.p_W);
  ASSERT_EQ(sent.sightings.size(), 1);
  EXPECT_NEAR(sent.sightings[0].range_m, 90.0, 0.05);
  ASSERT_EQ(sent.ranges.size(), 2);
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(sent.ranges[k].source, s.ranges[k].source);
    EXPECT_NEAR(sent.ranges[k].range_m, s.ranges[k].range_m, 0.16);
    EXPECT_NEAR(static_cast<double>(sent.ranges[k].stamp - s.ranges[k].stamp), 0.0, 0.0626e9);
  }
}

TEST(LocatedPacket, AStationTellsABearingBesideTwoRanges) {
  const AgentModel model = Model("ranges");
  const PacketCodec codec(model, PacketLayout::kMeasurements);
  NeighbourState s = Example();
  s.source = 4;
  s.has_bearing = true;
  constexpr double kStep_rad = 2.0 * 3.14159265358979323846 / 16383.0;
  for (const double azimuth : {-3.1, -0.5, 0.0, 1.25, 3.1}) {
    s.bearing = {3, 44'000'000'000, azimuth};
    const Packet packet = codec.Encode(s);
    const NeighbourState sent = codec.Decode(packet.data(), packet.size(), s.generation, s.p_W);
    ASSERT_TRUE(sent.has_bearing);
    EXPECT_EQ(sent.bearing.source, 3);
    EXPECT_NEAR(static_cast<double>(sent.bearing.stamp - s.bearing.stamp), 0.0, 0.0626e9);
    EXPECT_NEAR(sent.bearing.azimuth_rad, azimuth, 0.51 * kStep_rad);
    EXPECT_EQ(sent.sightings.size(), 0);
    EXPECT_EQ(sent.ranges.size(), 2);
  }
  s.bearing.source = 5;
  EXPECT_THROW(codec.Encode(s), std::invalid_argument);
}

TEST(LocatedPacket, CarriesAFixInPlaceOfTheRanges) {
  const AgentModel model = Model("ranges");
  const PacketCodec codec(model, PacketLayout::kMeasurements);
  const MeasurementPacket layout(model);
  NeighbourState s = Example();
  s.has_fix = true;
  for (const double error : {-60000.0, -3.0, 0.0, 812.34, 40000.0}) {
    for (const double std_m : {0.5, 3.0, 20.0}) {
      s.fix = {s.generation - 700'000'000, error, -0.5 * error, std_m};
      s.surfacing = error > 0.0;
      const Packet packet = codec.Encode(s);
      const NeighbourState sent = codec.Decode(packet.data(), packet.size(), s.generation, s.p_W);
      ASSERT_TRUE(sent.has_fix);
      EXPECT_EQ(sent.surfacing, s.surfacing);
      EXPECT_EQ(sent.ranges.size(), 0);
      EXPECT_FALSE(sent.saturated);
      EXPECT_NEAR(static_cast<double>(sent.fix.stamp - s.fix.stamp), 0.0, 0.0626e9);
      EXPECT_NEAR(sent.fix.error_x, error, 1.001 * layout.sent_fix_error_m());
      EXPECT_NEAR(sent.fix.error_y, -0.5 * error, 1.001 * layout.sent_fix_error_m());
      EXPECT_GE(sent.fix.std_m, std_m * (1.0 - 1e-9));
      EXPECT_LT(sent.fix.std_m, 1.27 * std_m);
    }
  }
  EXPECT_LT(layout.sent_fix_error_m(), 0.04);
  s.fix.stamp = s.generation + 1;
  EXPECT_THROW(codec.Encode(s), std::invalid_argument);
  // A station cannot have a fix.
  s.fix.stamp = s.generation;
  s.source = 4;
  const Packet packet = codec.Encode(s);
  EXPECT_THROW(codec.Decode(packet.data(), packet.size(), s.generation, s.p_W), UserError);
}

TEST(LocatedPacket, AStationSpeaksTheSameLayoutAndOthersDoNot) {
  const AgentModel model = Model("ranges");
  const PacketCodec codec(model, PacketLayout::kMeasurements);
  NeighbourState s = Example();
  s.source = 4;
  s.ranges.clear();
  const Packet packet = codec.Encode(s);
  const NeighbourState sent = codec.Decode(packet.data(), packet.size(), s.generation, s.p_W);
  EXPECT_EQ(sent.source, 4);
  EXPECT_EQ(sent.ranges.size(), 0);
  const PacketCodec plain(Model("uncorrected"), PacketLayout::kMeasurements);
  EXPECT_THROW(plain.Decode(packet.data(), packet.size(), s.generation), UserError);
  s.source = 5;
  EXPECT_THROW(codec.Encode(s), std::invalid_argument);
}

}  // namespace
}  // namespace stg::agent

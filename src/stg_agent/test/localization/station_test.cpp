// What a beacon's packet tells: its place, and the ranges of the packets that it heard.

#include "stg_agent/stations/station.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "stg_agent/agent_config.hpp"

namespace stg::agent {
namespace {

constexpr TimeNs kHeard = 1'000'000'000;  ///< time of both packets

std::shared_ptr<const AgentConstants> Constants(const std::string& by) {
  AgentScenario s;
  s.run.agents = 3;
  s.run.time.dt_s = 0.5;
  s.run.time.decision_steps = 2;
  s.world.navigation.kind = "dead_reckoning";
  s.channel.physical.water.sound_speed = acoustics::WaterConfig::SoundSpeed::kProfile;
  s.channel.physical.water.profile_speeds_mps.fill(1500.0);
  s.agent.track.filter = "measurements";
  s.agent.localization.kind = "ranges";
  s.agent.localization.by = by == "ping" ? RangesBy::kPing : RangesBy::kOneWay;
  s.agent.stations.beacons = {{0.0, 0.0, -50.0}};
  return std::make_shared<const AgentConstants>(s.model());
}

/// The beacon hears a packet of AUV 1 that travelled 300 m and one of AUV 2 that travelled 450 m.
NeighbourState AfterTwoPackets(const AgentConstants& constants, Station* beacon) {
  for (int id : {1, 2}) {
    NeighbourState state;
    state.source = id;
    state.generation = kHeard;
    state.p_W = {150.0 + 150.0 * id, 0.0, -50.0};
    const Packet packet = constants.codec.Encode(state);
    acoustics::Reception reception;
    reception.source = id;
    reception.transmit = kHeard;
    reception.arrival = kHeard + kHeard / 2;
    reception.travel_time_s = state.p_W.x / 1500.0;
    reception.payload = acoustics::ViewOf(packet);
    beacon->Receive(reception, state.p_W);
  }
  beacon->Advance(2 * kHeard, 2);
  const Packet sent = beacon->MakePacket();
  return constants.codec.Decode(sent.data(), sent.size(), 3 * kHeard, {});
}

TEST(Station, ABeaconTellsTheRangesThatItMeasured) {
  const auto constants = Constants("one_way");
  Station beacon(constants, 0);
  const NeighbourState sent = AfterTwoPackets(*constants, &beacon);
  ASSERT_EQ(sent.ranges.size(), 2u);
  for (const SentRange& range : sent.ranges) {
    EXPECT_NEAR(range.range_m, 150.0 + 150.0 * range.source, 0.4);
    EXPECT_NEAR(static_cast<double>(range.stamp), static_cast<double>(kHeard), 0.2e9);
  }
  EXPECT_NE(sent.ranges[0].source, sent.ranges[1].source);
  beacon.Reset(0, 1);
  const Packet fresh = beacon.MakePacket();
  EXPECT_TRUE(constants->codec.Decode(fresh.data(), fresh.size(), kHeard, {}).ranges.empty());
}

TEST(Station, ABeaconThatAnswersPingsTellsNoTravelTimes) {
  const auto constants = Constants("ping");
  Station beacon(constants, 0);
  EXPECT_TRUE(AfterTwoPackets(*constants, &beacon).ranges.empty());
}

}  // namespace
}  // namespace stg::agent

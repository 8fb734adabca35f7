#include "acoustic_channel/offline/traffic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "acoustic_channel/log/packet_log.hpp"
#include "acoustic_channel/modem/modem_profile.hpp"
#include "acoustic_channel/offline/track.hpp"
#include "auv_common/error.hpp"
#include "scratch_file.hpp"

namespace stg::acoustics {
namespace {

constexpr TimeNs kSecond = 1'000'000'000;

TrafficSpec Poisson(int source, double rate_hz) {
  TrafficSpec flow;
  flow.source = source;
  flow.rate_hz = rate_hz;
  flow.bytes = 8;
  return flow;
}

TEST(Traffic, PoissonFlowsHaveTheRateAndNoMemory) {
  Traffic traffic({Poisson(0, 2.0)}, 3);
  std::vector<Offer> offers;
  traffic.Take(50000 * kSecond, &offers);
  const double n = static_cast<double>(offers.size());
  EXPECT_NEAR(n, 100000.0, 4.0 * std::sqrt(100000.0));
  double square = 0.0;
  for (std::size_t i = 1; i < offers.size(); ++i) {
    const double gap = Seconds(offers[i].t - offers[i - 1].t);
    ASSERT_GE(gap, 0.0);
    square += gap * gap;
  }
  EXPECT_NEAR(square / n, 2.0 * 0.25, 0.01);
}

TEST(Traffic, FlowsComeInOrderAndDoNotDependOnEachOther) {
  std::vector<Offer> together, alone;
  TrafficSpec periodic;
  periodic.kind = TrafficSpec::Kind::kPeriodic;
  periodic.source = 1;
  periodic.period_s = 0.3;
  periodic.offset_s = 0.1;
  TrafficSpec at;
  at.kind = TrafficSpec::Kind::kAt;
  at.source = 2;
  at.times_s = {0.1, 5.0, 7.25};
  Traffic all({Poisson(0, 3.0), periodic, at}, 9);
  for (TimeNs t = 0; t <= 10 * kSecond; t += kSecond / 3) all.Take(t, &together);
  all.Take(10 * kSecond, &together);
  Traffic one({Poisson(0, 3.0)}, 9);
  one.Take(10 * kSecond, &alone);

  std::vector<TimeNs> of[3];
  for (std::size_t i = 0; i < together.size(); ++i) {
    if (i > 0) {
      ASSERT_LE(together[i - 1].t, together[i].t);
    }
    of[together[i].source].push_back(together[i].t);
  }
  ASSERT_EQ(of[0].size(), alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(of[0][i], alone[i].t);
  ASSERT_EQ(of[1].size(), 34u);  // 0.1, 0.4, ... 10.0
  EXPECT_EQ(of[1][33], 10 * kSecond);
  EXPECT_EQ(of[2], (std::vector<TimeNs>{kSecond / 10, 5 * kSecond, 7250 * kSecond / 1000}));
}

class TrackFile : public ::testing::Test {
 protected:
  Track Load(const std::string& text) {
    const ScratchFile file(text, ".csv");
    path_ = file.path();
    return Track::Load(path_);
  }
  std::string Refusal(const std::string& text) {
    try {
      Load(text);
    } catch (const UserError& e) {
      return std::string(e.what()).substr(path_.size());
    }
    return "";
  }
  std::string path_;
};

TEST_F(TrackFile, GoesOnStraightLinesAndRestsAtItsEnds) {
  const Track track = Load("t,x,y,z\n1,0,0,-5\n3,4,-2,-5\r\n4, 4, -2, -6\n");
  Vec3<double> p, v;
  track.At(0.0, &p, &v);
  EXPECT_EQ(p.z, -5.0);
  EXPECT_EQ(Norm(v), 0.0);
  track.At(2.0, &p, &v);
  EXPECT_EQ(p.x, 2.0);
  EXPECT_EQ(p.y, -1.0);
  EXPECT_EQ(v.x, 2.0);
  track.At(3.0, &p, &v);
  EXPECT_EQ(v.x, 0.0);
  EXPECT_EQ(v.z, -1.0);
  track.At(9.0, &p, &v);
  EXPECT_EQ(p.z, -6.0);
  EXPECT_EQ(Norm(v), 0.0);
}

TEST_F(TrackFile, MayBeginWithAByteOrderMark) {
  Vec3<double> p, v;
  Load("\xEF\xBB\xBFt,x,y,z\n1,2,3,-5\n").At(0.0, &p, &v);
  EXPECT_EQ(p.x, 2.0);
}

TEST_F(TrackFile, BadRowsAreRefusedWithTheirLine) {
  EXPECT_EQ(Refusal("x,y,z\n1,2,3\n"), ":1: expected the header t,x,y,z, found 'x,y,z'");
  EXPECT_NE(Refusal("t,x,y,z\n0,1,2,3\n1,2,nan,3\n").find(":3: expected four"), std::string::npos);
  EXPECT_NE(Refusal("t,x,y,z\n0,1,2\n").find(":2: expected four"), std::string::npos);
  EXPECT_NE(Refusal("t,x,y,z\n0,1,2,3,4\n").find(":2: expected four"), std::string::npos);
  EXPECT_NE(Refusal("t,x,y,z\n0,1,2,3m\n").find(":2: expected four"), std::string::npos);
  EXPECT_NE(Refusal("t,x,y,z\n5,1,2,3\n5,1,2,3\n").find(":3: t: each time must be later"),
            std::string::npos);
  EXPECT_NE(Refusal("t,x,y,z\n").find("no points"), std::string::npos);
}

TEST_F(TrackFile, WhatNoVehicleDoesIsRefused) {
  EXPECT_EQ(Refusal("t,x,y,z\n0,1,2,-3\n1e300,1,2,-3\n"), ":3: t: beyond +-1e8 s");
  EXPECT_EQ(Refusal("t,x,y,z\n-1e9,1,2,-3\n"), ":2: t: beyond +-1e8 s");
  EXPECT_EQ(Refusal("t,x,y,z\n0,1,-1e300,-3\n"), ":2: x, y, z: beyond +-1e7 m");
  const std::string fast = ":3: faster than 100 m/s since the point before";
  EXPECT_EQ(Refusal("t,x,y,z\n0,0,0,0\n1,100,0,0\n"), "");
  EXPECT_EQ(Refusal("t,x,y,z\n0,0,0,0\n1,0,0,-101\n"), fast);
  EXPECT_EQ(Refusal("t,x,y,z\n0,0,0,0\n1e-300,1,0,0\n"), fast);
}

TEST(PacketLog, WritesARowForEveryReceiverWithExactTimes) {
  std::ostringstream out;
  PacketLog log(&out, 3, {"4", "7", "9"}, 100 * kSecond);
  PacketInfo packet;
  packet.source = 1;
  packet.bytes = 32;
  packet.offered = packet.generation = -kSecond / 2;
  log.OnDiscarded(packet, DropReason::kQueue, 0);
  const auto mode = ModemProfiles().Make("janus");
  packet.mode = mode.get();
  packet.sequence = 3;
  packet.transmit = 5;
  packet.transmit_end = kSecond + 5;
  PacketFate fate;
  fate.receiver = 2;
  fate.begin = 2 * kSecond + 5;
  fate.arrival = 3 * kSecond + 5;
  fate.distance_m = 3000.0;
  fate.travel_time_s = 2.0;
  fate.received_level_db = 120.25;
  fate.noise_level_db = 80.0;
  fate.sinr_db = 40.25;
  fate.loss_probability = 0.125;
  log.OnFate(packet, fate);
  fate.receiver = 0;
  fate.reason = DropReason::kHalfDuplex;
  log.OnFate(packet, fate);
  std::istringstream in(out.str());
  std::string row;
  std::getline(in, row);
  const auto columns = std::count(row.begin(), row.end(), ',');
  std::getline(in, row);
  EXPECT_EQ(row, "7,4,all,data,,32,99.500000000,99.500000000,,,,,,,,,,,queue,");
  EXPECT_EQ(std::count(row.begin(), row.end(), ','), columns);
  std::getline(in, row);
  EXPECT_EQ(row.substr(0, 4), "7,9,");
  std::getline(in, row);
  EXPECT_EQ(row,
            "7,9,all,data,3,32,99.500000000,99.500000000,100.000000005,101.000000005,"
            "102.000000005,103.000000005,3000.000,2.000000000,120.250,80.000,40.250,0.125000,"
            "delivered,janus");
  std::getline(in, row);
  EXPECT_EQ(row.substr(row.rfind(",half")), ",half_duplex,janus");
  EXPECT_EQ(std::count(row.begin(), row.end(), ','), columns);
  EXPECT_EQ(log.rows(), 4u);
}

}  // namespace
}  // namespace stg::acoustics

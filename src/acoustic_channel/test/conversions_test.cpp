#include "acoustic_channel/nodes/conversions.hpp"

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Twist.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace stg::nodes {
namespace {

TEST(ReceivedPacket, RoundTripKeepsAllThatAModemKnows) {
  const std::uint8_t bytes[] = {0, 255, 7, 42, 1};
  const TimeNs start = 1'234'567'890'123;
  acoustics::Reception r;
  r.source = 3;
  r.receiver = 5;
  r.destination = 5;
  r.sequence = 4'000'000'000u;
  r.generation = 100'000'001;
  r.transmit = 200'000'002;
  r.arrival = 300'000'003;
  r.travel_time_s = 0.1;
  r.loss_probability = 0.2;
  r.link_quality = 0.3;
  r.received_level_db = 104.5;
  r.noise_level_db = 60.25;
  r.sinr_db = 44.25;
  r.doppler_mps = -1.5;
  r.has_direction = true;
  r.azimuth_rad = 0.7;
  r.elevation_rad = -0.4;
  r.payload = {bytes, sizeof(bytes)};
  for (const int destination : {5, acoustics::kToAll}) {
    r.destination = destination;
    auv_msgs::ReceivedPacket m;
    m.data.assign(100, 9);  // bytes of an earlier packet
    SetReceivedPacket(r, start, &m);
    EXPECT_EQ(NsOf(m.arrival), start + r.arrival);
    const acoustics::Reception back = ReceptionOf(m, r.receiver, start);
    EXPECT_EQ(back.source, r.source);
    EXPECT_EQ(back.receiver, r.receiver);
    EXPECT_EQ(back.destination, destination);
    EXPECT_EQ(back.sequence, r.sequence);
    EXPECT_EQ(back.generation, r.generation);
    EXPECT_EQ(back.transmit, r.transmit);
    EXPECT_EQ(back.arrival, r.arrival);
    EXPECT_EQ(back.travel_time_s, r.travel_time_s);
    EXPECT_EQ(back.loss_probability, r.loss_probability);
    EXPECT_EQ(back.link_quality, r.link_quality);
    EXPECT_EQ(back.received_level_db, r.received_level_db);
    EXPECT_EQ(back.noise_level_db, r.noise_level_db);
    EXPECT_EQ(back.sinr_db, r.sinr_db);
    EXPECT_EQ(back.doppler_mps, r.doppler_mps);
    EXPECT_TRUE(back.has_direction);
    EXPECT_EQ(back.azimuth_rad, r.azimuth_rad);
    EXPECT_EQ(back.elevation_rad, r.elevation_rad);
    ASSERT_EQ(back.payload.size, sizeof(bytes));
    EXPECT_TRUE(std::equal(bytes, bytes + sizeof(bytes), back.payload.data));
  }
}

TEST(WorldVelocity, TurnsTheBodysVelocityIntoTheWorld) {
  geometry_msgs::Pose pose;
  pose.orientation.w = pose.orientation.z = std::sqrt(0.5);  // the bow points along y
  geometry_msgs::Twist twist;
  twist.linear.x = 2.0;
  twist.linear.y = 1.0;
  twist.linear.z = 0.5;
  const Vec3<double> v_W = WorldVelocity(pose, twist);
  EXPECT_NEAR(v_W.x, -1.0, 1e-15);
  EXPECT_NEAR(v_W.y, 2.0, 1e-15);
  EXPECT_NEAR(v_W.z, 0.5, 1e-15);
}

}  // namespace
}  // namespace stg::nodes

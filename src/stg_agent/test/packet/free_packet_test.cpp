// The packet of measurements for AUVs that choose their targets freely.

#include <gtest/gtest.h>

#include <random>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "estimation/fleet.hpp"
#include "stg_agent/packet/measurement_packet.hpp"

namespace stg::agent {
namespace {

constexpr TimeNs kFreeSecond = 1'000'000'000;

AgentModel FreeScenario(const std::string& sensor, int targets) {
  FleetOptions o;
  o.sensor = sensor;
  o.observers = 4;
  AgentScenario s = FleetScenario(o);
  config::Override(&s, {"task.assignment=free", "target.count=" + std::to_string(targets)});
  return s.model();
}

dynamics::Detection RangeOf(int target, TimeNs stamp, double range_m, const Vec3<double>& p_WO) {
  dynamics::Detection d;
  d.kind = dynamics::MeasurementKind::kRange;
  d.target = target;
  d.stamp = stamp;
  d.range_m = range_m;
  d.p_WO = d.p_WT = p_WO;
  return d;
}

/// A sender at 100 s. Its ranges have the given (target, age [s]). The first one is 110 m long, and
/// each further one is 10 m longer.
NeighbourState Sender(std::initializer_list<std::pair<int, int>> sightings) {
  NeighbourState n;
  n.source = 2;
  n.generation = 100 * kFreeSecond;
  n.p_W = {100.0, -200.0, -30.0};
  n.followed = 3;
  for (const auto& [target, age] : sightings) {
    const double range_m = 110.0 + 10.0 * n.sightings.size();
    n.sightings.push_back(RangeOf(target, n.generation - age * kFreeSecond, range_m,
                                  n.p_W - Vec3<double>{1.0 * age, 0.0, 0.0}));
  }
  n.has_target = !n.sightings.empty();
  return n;
}

NeighbourState ThereAndBack(const NeighbourState& in, const AgentModel& s) {
  const MeasurementPacket codec(s);
  const Packet p = codec.Encode(in);
  return codec.Decode(p.data(), p.size(), in.generation + 3 * kFreeSecond);
}

void ExpectFirst(const NeighbourState& in, const NeighbourState& out, int count,
                 const AgentModel& s) {
  const MeasurementPacket codec(s);
  EXPECT_EQ(out.followed, in.followed);
  EXPECT_FALSE(out.saturated);
  ASSERT_EQ(out.sightings.size(), count);
  for (int k = 0; k < count; ++k) {
    const dynamics::Detection &a = in.sightings[k], &b = out.sightings[k];
    EXPECT_EQ(a.target, b.target) << k;
    EXPECT_EQ(a.stamp, b.stamp) << k;
    EXPECT_NEAR(a.range_m, b.range_m, codec.range_error_m() + 1e-9) << k;
    EXPECT_NEAR(b.range_std_m, 1.0 + 0.01 * b.range_m, 1e-12) << k;
    EXPECT_NEAR(a.p_WO.x, b.p_WO.x, codec.position_error_m() + codec.offset_error_m() + 1e-9) << k;
  }
}

TEST(FreePackets, FiveRangesOfOneLookFit) {
  const AgentModel s = FreeScenario("range", 5);
  const NeighbourState in = Sender({{3, 4}, {0, 4}, {1, 4}, {2, 4}, {4, 4}});
  ExpectFirst(in, ThereAndBack(in, s), 5, s);
}

TEST(FreePackets, ThreeRangesOfTwoLooksFit) {
  const AgentModel s = FreeScenario("range", 5);
  const NeighbourState two = Sender({{3, 4}, {0, 4}, {1, 9}, {2, 9}});
  ExpectFirst(two, ThereAndBack(two, s), 3, s);
  const NeighbourState one = Sender({{3, 4}, {0, 9}, {1, 9}, {2, 9}});
  ExpectFirst(one, ThereAndBack(one, s), 3, s);
  const NeighbourState three = Sender({{3, 4}, {0, 4}, {1, 4}, {2, 9}});
  ExpectFirst(three, ThereAndBack(three, s), 3, s);
}

TEST(FreePackets, WhomItFollowsIsToldWithoutMeasurements) {
  const AgentModel s = FreeScenario("range", 15);
  NeighbourState in = Sender({});
  for (const int followed : {-1, 0, 14}) {
    in.followed = followed;
    const NeighbourState out = ThereAndBack(in, s);
    EXPECT_EQ(out.followed, followed);
    EXPECT_FALSE(out.has_target);
  }
}

TEST(FreePackets, MeasurementsOfOtherSensorsCarryTheirTargets) {
  for (const char* sensor : {"position", "bearing", "range_bearing"}) {
    const AgentModel s = FreeScenario(sensor, 9);
    const auto kind = dynamics::TargetSensors().Make(s.sensing.sensor, s.sensing)->kind();
    NeighbourState in = Sender({{8, 4}, {3, 7}});
    for (dynamics::Detection& d : in.sightings) {
      d.kind = kind;
      d.azimuth_rad = 1.0;
      d.p_WT = in.p_W + Vec3<double>{50.0, 60.0, 0.0};
    }
    const NeighbourState out = ThereAndBack(in, s);
    ASSERT_EQ(out.sightings.size(), 2) << sensor;
    EXPECT_EQ(out.followed, 3);
    EXPECT_EQ(out.sightings[0].target, 8);
    EXPECT_EQ(out.sightings[1].target, 3);
    EXPECT_EQ(out.sightings[1].stamp, in.sightings[1].stamp);
  }
}

TEST(FreePackets, OfAnotherAssignmentAreRefused) {
  const AgentModel free = FreeScenario("range", 5);
  AgentModel modulo = free;
  modulo.task.assignment = Assignment::kModulo;
  const NeighbourState in = Sender({});
  const Packet p = MeasurementPacket(modulo).Encode(in), q = MeasurementPacket(free).Encode(in);
  EXPECT_THROW(MeasurementPacket(free).Decode(p.data(), p.size(), 200 * kFreeSecond), UserError);
  EXPECT_THROW(MeasurementPacket(modulo).Decode(q.data(), q.size(), 200 * kFreeSecond), UserError);
}

TEST(FreePackets, DamageIsRefusedOrDecodesToWhatFits) {
  const AgentModel s = FreeScenario("range", 5);
  const MeasurementPacket codec(s);
  const Packet good = codec.Encode(Sender({{3, 4}, {0, 4}, {1, 9}}));
  std::mt19937_64 random(1);
  int refused = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    Packet bad = good;
    for (int flips = 0; flips < 6; ++flips) bad[random() % 32] ^= 1U << (random() % 8);
    try {
      const NeighbourState n = codec.Decode(bad.data(), bad.size(), 200 * kFreeSecond);
      EXPECT_LT(n.followed, 5);
      for (const dynamics::Detection& d : n.sightings) EXPECT_LT(d.target, 5);
    } catch (const UserError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 4900);
}

}  // namespace
}  // namespace stg::agent

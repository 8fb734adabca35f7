#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "auv_common/error.hpp"
#include "packet/packet_examples.hpp"

namespace stg::agent {
namespace {

PacketField Field(const PacketCodec& codec, const std::string& name) {
  for (const PacketField& f : codec.fields()) {
    if (f.name == name) return f;
  }
  throw std::out_of_range(name);
}

NeighbourState RoundTrip(const PacketCodec& codec, const NeighbourState& s) {
  const Packet packet = codec.Encode(s);
  return codec.Decode(packet.data(), packet.size(), s.generation + 10 * kMs);
}

TEST(Packet, ResolutionsSufficeForTheShippedWorkspace) {
  const PacketCodec codec{AgentModel{}};
  EXPECT_LE(Field(codec, "position").resolution, 1e-4);
  EXPECT_LE(Field(codec, "target_position").resolution, 1e-4);
  EXPECT_LE(Field(codec, "velocity").resolution, 1e-3);
  EXPECT_LE(Field(codec, "target_velocity").resolution, 1e-4);
  EXPECT_LE(Field(codec, "position").lo, -1.0);
  EXPECT_GE(Field(codec, "position").hi, 1.0);
  EXPECT_GE(Field(codec, "velocity").hi, std::sqrt(1.5 * 1.5 + 2 * 0.5 * 0.5));
}

TEST(Packet, BitCountsFollowTheClosedForm) {
  for (const double half_extent : {1.0, 1000.0}) {
    AgentModel s;
    s.workspace.half_extent_m = half_extent;
    for (const PacketField& f : PacketCodec(s).fields()) {
      // The small number is subtracted because rounding of the quotient must not add a bit.
      const double levels = (f.hi - f.lo) / f.resolution + 1.0;
      EXPECT_EQ(f.bits, static_cast<int>(std::ceil(std::log2(levels) - 1e-9))) << f.name;
    }
  }
}

TEST(Packet, RoundTripErrorIsAtMostHalfTheResolution) {
  const AgentModel scenario = TestScenario();
  const PacketCodec codec(scenario);
  std::mt19937_64 engine(7);
  const auto draw = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(engine);
  };
  const auto in = [&](const char* name) {
    const PacketField f = Field(codec, name);
    return draw(f.lo, f.hi);
  };
  const auto near = [&](const char* name, double a, double b) {
    EXPECT_LE(std::abs(a - b), 0.5 * Field(codec, name).resolution * (1 + 1e-9)) << name;
  };
  const auto vector_near = [&](const char* name, const Vec3<double>& a, const Vec3<double>& b) {
    near(name, a.x, b.x);
    near(name, a.y, b.y);
    near(name, a.z, b.z);
  };
  for (int trial = 0; trial < 5000; ++trial) {
    NeighbourState s;
    s.source = static_cast<int>(engine() % 7);
    s.generation = static_cast<TimeNs>(engine() % (1000 * kSecond)) + 40 * kSecond;
    s.p_W = {in("position"), in("position"), in("position")};
    s.v_W = {in("velocity"), in("velocity"), in("velocity")};
    s.confidence = in("confidence");
    s.tracking_error = in("tracking_error");
    s.phase = static_cast<int>(engine() % 4);
    s.link_quality = in("link_quality");
    s.has_target = true;
    s.target = static_cast<int>(engine() % 3);
    s.target_stamp = s.generation - static_cast<TimeNs>(engine() % (32 * kSecond));
    s.p_WT = {in("target_position"), in("target_position"), in("target_position")};
    s.v_WT = {in("target_velocity"), in("target_velocity"), in("target_velocity")};
    s.target_std = std::exp(in("log_target_std"));
    const NeighbourState r = RoundTrip(codec, s);
    EXPECT_EQ(r.source, s.source);
    EXPECT_EQ(r.phase, s.phase);
    EXPECT_EQ(r.target, s.target);
    EXPECT_TRUE(r.has_target);
    EXPECT_FALSE(r.saturated);
    EXPECT_LE(std::abs(r.generation - s.generation), kMs / 2);
    EXPECT_LE(std::abs(r.target_stamp - s.target_stamp), kMs / 2);
    vector_near("position", r.p_W, s.p_W);
    vector_near("velocity", r.v_W, s.v_W);
    near("confidence", r.confidence, s.confidence);
    near("tracking_error", r.tracking_error, s.tracking_error);
    near("link_quality", r.link_quality, s.link_quality);
    vector_near("target_position", r.p_WT, s.p_WT);
    vector_near("target_velocity", r.v_WT, s.v_WT);
    near("log_target_std", std::log(r.target_std), std::log(s.target_std));
    if (HasFailure()) break;
  }
}

TEST(Packet, DecodedStateEncodesToTheSameBytes) {
  const PacketCodec codec(TestScenario());
  const Packet once = codec.Encode(Example());
  const NeighbourState decoded = codec.Decode(once.data(), once.size(), 10 * kSecond);
  EXPECT_EQ(codec.Encode(decoded), once);
}

TEST(Packet, ZeroAndTheEndsOfTheUnitIntervalAreExact) {
  const PacketCodec codec(TestScenario());
  NeighbourState s;
  s.has_target = true;
  s.target_std = 0.01;
  NeighbourState r = RoundTrip(codec, s);
  for (const Vec3<double>& v : {r.p_W, r.v_W, r.p_WT, r.v_WT}) {
    EXPECT_EQ(v.x, 0.0);
    EXPECT_EQ(v.y, 0.0);
    EXPECT_EQ(v.z, 0.0);
  }
  EXPECT_EQ(r.confidence, 0.0);
  EXPECT_EQ(r.tracking_error, 0.0);
  s.confidence = s.link_quality = 1.0;
  r = RoundTrip(codec, s);
  EXPECT_EQ(r.confidence, 1.0);
  EXPECT_EQ(r.link_quality, 1.0);
}

TEST(Packet, HeaderBitsAreWhereTheLayoutSaysTheyAre) {
  const Packet p = PacketCodec(TestScenario()).Encode(Example());
  // Version 1, source 5, generation 0x1234 ms, least significant bit first.
  EXPECT_EQ(p[0], 0x51);
  EXPECT_EQ(p[1], 0x40);
  EXPECT_EQ(p[2], 0x23);
  EXPECT_EQ(p[3] & 0x0F, 0x01);
  Packet sealed = p;
  Seal(&sealed);
  EXPECT_EQ(sealed.back(), p.back()) << "checksum differs from its bitwise definition";
}

TEST(Packet, AbsentTargetTravelsAsZeros) {
  const PacketCodec codec(TestScenario());
  NeighbourState s = Example();
  s.has_target = false;
  const Packet packet = codec.Encode(s);
  // The target begins at bit 141.
  for (std::size_t i = 18; i < 31; ++i) EXPECT_EQ(packet[i], 0) << i;
  const NeighbourState r = codec.Decode(packet.data(), packet.size(), 10 * kSecond);
  EXPECT_FALSE(r.has_target);
  EXPECT_EQ(r.target, 0);
  EXPECT_EQ(r.target_std, 0.0);
}

TEST(Packet, ValuesOutsideTheirRangeSaturateAtBothEndsAndSaySo) {
  const PacketCodec codec(TestScenario());
  struct Case {
    const char* field;
    std::function<double*(NeighbourState*)> value;
  };
  const std::vector<Case> cases{
      {"position", [](NeighbourState* s) { return &s->p_W.x; }},
      {"position", [](NeighbourState* s) { return &s->p_W.y; }},
      {"position", [](NeighbourState* s) { return &s->p_W.z; }},
      {"velocity", [](NeighbourState* s) { return &s->v_W.x; }},
      {"velocity", [](NeighbourState* s) { return &s->v_W.y; }},
      {"velocity", [](NeighbourState* s) { return &s->v_W.z; }},
      {"confidence", [](NeighbourState* s) { return &s->confidence; }},
      {"tracking_error", [](NeighbourState* s) { return &s->tracking_error; }},
      {"link_quality", [](NeighbourState* s) { return &s->link_quality; }},
      {"target_position", [](NeighbourState* s) { return &s->p_WT.x; }},
      {"target_position", [](NeighbourState* s) { return &s->p_WT.y; }},
      {"target_position", [](NeighbourState* s) { return &s->p_WT.z; }},
      {"target_velocity", [](NeighbourState* s) { return &s->v_WT.x; }},
      {"target_velocity", [](NeighbourState* s) { return &s->v_WT.y; }},
      {"target_velocity", [](NeighbourState* s) { return &s->v_WT.z; }},
  };
  ASSERT_FALSE(RoundTrip(codec, Example()).saturated);
  for (const Case& c : cases) {
    const PacketField f = Field(codec, c.field);
    for (const double huge : {1.0, 1e300}) {
      NeighbourState s = Example();
      *c.value(&s) = f.hi + huge;
      NeighbourState r = RoundTrip(codec, s);
      EXPECT_TRUE(r.saturated) << c.field;
      EXPECT_DOUBLE_EQ(*c.value(&r), f.hi) << c.field;
      *c.value(&s) = f.lo - huge;
      r = RoundTrip(codec, s);
      EXPECT_TRUE(r.saturated) << c.field;
      EXPECT_DOUBLE_EQ(*c.value(&r), f.lo) << c.field;
    }
    NeighbourState s = Example();
    *c.value(&s) = f.hi;
    EXPECT_FALSE(RoundTrip(codec, s).saturated) << c.field;
    *c.value(&s) = f.lo;
    EXPECT_FALSE(RoundTrip(codec, s).saturated) << c.field;
  }
}

TEST(Packet, TargetDeviationAndAgeSaturateAtBothEndsAndSaySo) {
  const PacketCodec codec(TestScenario());
  const PacketField f = Field(codec, "log_target_std");
  NeighbourState s = Example();
  s.target_std = 0.0;
  EXPECT_TRUE(RoundTrip(codec, s).saturated);
  EXPECT_NEAR(RoundTrip(codec, s).target_std, std::exp(f.lo), 1e-12);
  s.target_std = 1e6;
  EXPECT_TRUE(RoundTrip(codec, s).saturated);
  EXPECT_NEAR(RoundTrip(codec, s).target_std, std::exp(f.hi), 1e-9);

  s = Example();
  s.generation = 100 * kSecond;
  s.target_stamp = s.generation - 32767 * kMs;
  EXPECT_FALSE(RoundTrip(codec, s).saturated);
  EXPECT_EQ(RoundTrip(codec, s).target_stamp, s.target_stamp);
  s.target_stamp = s.generation - 90 * kSecond;
  EXPECT_TRUE(RoundTrip(codec, s).saturated);
  EXPECT_EQ(RoundTrip(codec, s).target_stamp, s.generation - 32767 * kMs);
  s.target_stamp = s.generation + kSecond;
  EXPECT_TRUE(RoundTrip(codec, s).saturated);
  EXPECT_EQ(RoundTrip(codec, s).target_stamp, s.generation);
}

TEST(Packet, GenerationTimeIsReconstructedAcrossTheWrap) {
  const PacketCodec codec(TestScenario());
  NeighbourState s = Example();
  s.has_target = false;
  for (const TimeNs generation : {TimeNs{0}, 65'535 * kMs, 65'536 * kMs, 65'537 * kMs,
                                  131'071'600'000, 1'000'000 * kSecond + 123'456'789}) {
    s.generation = generation;
    const Packet packet = codec.Encode(s);
    for (const TimeNs delay :
         {TimeNs{0}, TimeNs{1}, 499'999L, 500'000L, kMs, 2 * kSecond, 65 * kSecond, 65'534 * kMs}) {
      const TimeNs now = generation + delay;
      const TimeNs decoded = codec.Decode(packet.data(), packet.size(), now).generation;
      EXPECT_LE(std::abs(decoded - generation), kMs / 2) << generation << " + " << delay;
      EXPECT_LE(decoded, now);
    }
  }
  s.generation = 5 * kSecond;
  const Packet packet = codec.Encode(s);
  EXPECT_THROW(codec.Decode(packet.data(), packet.size(), 4 * kSecond), UserError);
}

}  // namespace
}  // namespace stg::agent

#include "acoustic_channel/packet.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>

#include "auv_dynamics/error.hpp"

namespace stg {
namespace {

constexpr TimeNs kMs = 1'000'000, kSecond = 1'000'000'000;

Scenario TestScenario() {
  Scenario s;
  s.agents = 7;
  s.target.count = 3;
  return s;
}

PacketField Field(const PacketCodec& codec, const std::string& name) {
  for (const PacketField& f : codec.fields()) {
    if (f.name == name) return f;
  }
  throw std::out_of_range(name);
}

/// A state well inside every range.
NeighbourState Example() {
  NeighbourState s;
  s.source = 5;
  s.generation = 0x1234 * kMs;
  s.p_W = {0.5, -0.25, 0.125};
  s.v_W = {1.0, -0.5, 0.25};
  s.confidence = 0.6;
  s.tracking_error = 0.2;
  s.phase = 2;
  s.link_quality = 0.4;
  s.has_target = true;
  s.target = 2;
  s.target_stamp = s.generation - 700 * kMs;
  s.p_WT = {-0.3, 0.9, -1.0};
  s.v_WT = {0.01, -0.02, 0.03};
  s.target_std = 0.004;
  return s;
}

NeighbourState RoundTrip(const PacketCodec& codec, const NeighbourState& s) {
  const Packet packet = codec.Encode(s);
  return codec.Decode(packet.data(), packet.size(), s.generation + 10 * kMs);
}

/// CRC-8 bit by bit, reflected polynomial 0x1D, initial value 0xFF: the definition.
void Seal(Packet* packet) {
  unsigned crc = 0xFF;
  for (std::size_t i = 0; i + 1 < packet->size(); ++i) {
    crc ^= (*packet)[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) ? (crc >> 1) ^ 0xB8u : crc >> 1;
  }
  packet->back() = static_cast<std::uint8_t>(crc);
}

void Flip(Packet* packet, int bit) {
  (*packet)[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1 << (bit % 8));
}

/// Overwrites `bits` bits from position `first`, then repairs the checksum.
void Overwrite(Packet* packet, int first, int bits, unsigned code) {
  for (int i = 0; i < bits; ++i) {
    const int bit = first + i;
    auto& byte = (*packet)[static_cast<std::size_t>(bit / 8)];
    byte =
        static_cast<std::uint8_t>((byte & ~(1 << (bit % 8))) | (((code >> i) & 1u) << (bit % 8)));
  }
  Seal(packet);
}

TEST(Packet, ResolutionsSufficeForTheShippedWorkspace) {
  const PacketCodec codec{Scenario{}};
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
    Scenario s;
    s.workspace.half_extent_m = half_extent;
    for (const PacketField& f : PacketCodec(s).fields()) {
      // The subtraction keeps rounding in the quotient from adding a bit.
      const double levels = (f.hi - f.lo) / f.resolution + 1.0;
      EXPECT_EQ(f.bits, static_cast<int>(std::ceil(std::log2(levels) - 1e-9))) << f.name;
    }
  }
}

TEST(Packet, RoundTripErrorIsAtMostHalfTheResolution) {
  const Scenario scenario = TestScenario();
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
  for (std::size_t i = 18; i < 31; ++i) EXPECT_EQ(packet[i], 0) << i;  // from bit 144 of 141
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

TEST(Packet, EveryDamageOfOneOrTwoBitsIsRefused) {
  const PacketCodec codec(TestScenario());
  const Packet intact = codec.Encode(Example());
  ASSERT_NO_THROW(codec.Decode(intact.data(), intact.size(), 10 * kSecond));
  for (int a = 0; a < 8 * kPacketBytes; ++a) {
    for (int b = a; b < 8 * kPacketBytes; ++b) {
      Packet damaged = intact;
      Flip(&damaged, a);
      if (b != a) Flip(&damaged, b);
      ASSERT_THROW(codec.Decode(damaged.data(), damaged.size(), 10 * kSecond), UserError)
          << "bits " << a << " and " << b;
    }
  }
}

TEST(Packet, EveryBurstOfUpToEightBitsIsRefused) {
  const PacketCodec codec(TestScenario());
  const Packet intact = codec.Encode(Example());
  for (int first = 0; first + 8 <= 8 * kPacketBytes; ++first) {
    for (int pattern = 1; pattern < 256; ++pattern) {
      Packet damaged = intact;
      for (int i = 0; i < 8; ++i) {
        if (pattern >> i & 1) Flip(&damaged, first + i);
      }
      ASSERT_THROW(codec.Decode(damaged.data(), damaged.size(), 10 * kSecond), UserError);
    }
  }
}

TEST(Packet, WrongSizesAndConstantBytesAreRefused) {
  const PacketCodec codec(TestScenario());
  std::vector<std::uint8_t> data(64, 0);
  for (std::size_t size : {0u, 1u, 31u, 33u, 64u}) {
    EXPECT_THROW(codec.Decode(data.data(), size, kSecond), UserError) << size;
  }
  EXPECT_THROW(codec.Decode(data.data(), 32, kSecond), UserError);
  data.assign(64, 0xFF);
  EXPECT_THROW(codec.Decode(data.data(), 32, kSecond), UserError);
}

TEST(Packet, ForeignVersionsIndicesAndCodesAreRefusedEvenWithAValidChecksum) {
  const PacketCodec codec(TestScenario());
  const Packet intact = codec.Encode(Example());
  const auto refused = [&](int first, int bits, unsigned code) {
    Packet p = intact;
    Overwrite(&p, first, bits, code);
    EXPECT_THROW(codec.Decode(p.data(), p.size(), 10 * kSecond), UserError) << first;
  };
  refused(0, 4, 2);         // version
  refused(4, 8, 7);         // source, of 7 AUVs
  refused(28, 15, 0x7FFF);  // spare position code
  refused(73, 12, 0xFFF);   // spare velocity code
  refused(141, 6, 3);       // target, of 3
  Packet p = intact;
  Overwrite(&p, 4, 8, 6);
  EXPECT_EQ(codec.Decode(p.data(), p.size(), 10 * kSecond).source, 6);
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

TEST(Packet, NonFiniteAndImpossibleValuesAreABug) {
  const PacketCodec codec(TestScenario());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf}) {
    for (int field = 0; field < 16; ++field) {
      NeighbourState s = Example();
      double* values[16] = {&s.p_W.x,        &s.p_W.y,  &s.p_W.z,      &s.v_W.x,
                            &s.v_W.y,        &s.v_W.z,  &s.confidence, &s.tracking_error,
                            &s.link_quality, &s.p_WT.x, &s.p_WT.y,     &s.p_WT.z,
                            &s.v_WT.x,       &s.v_WT.y, &s.v_WT.z,     &s.target_std};
      *values[field] = bad;
      EXPECT_THROW(codec.Encode(s), std::invalid_argument) << field;
    }
  }
  NeighbourState s = Example();
  s.source = 7;
  EXPECT_THROW(codec.Encode(s), std::invalid_argument);
  s = Example();
  s.target = 3;
  EXPECT_THROW(codec.Encode(s), std::invalid_argument);
  s = Example();
  s.phase = 4;
  EXPECT_THROW(codec.Encode(s), std::invalid_argument);
  s = Example();
  s.generation = -1;
  EXPECT_THROW(codec.Encode(s), std::invalid_argument);
  s = Example();
  s.target_std = -0.1;
  EXPECT_THROW(codec.Encode(s), std::invalid_argument);
}

TEST(Packet, ScenariosThatDoNotFitTheLayoutAreRefused) {
  Scenario s;
  s.agents = 256;
  s.target.count = 64;
  EXPECT_NO_THROW(PacketCodec{s});
  s.agents = 257;
  EXPECT_THROW(PacketCodec{s}, UserError);
  s.agents = 4;
  s.target.count = 65;
  EXPECT_THROW(PacketCodec{s}, UserError);
}

}  // namespace
}  // namespace stg

// Damaged, foreign and impossible packets.

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include "auv_common/error.hpp"
#include "packet/packet_examples.hpp"

namespace stg::agent {
namespace {

void Flip(Packet* packet, int bit) {
  (*packet)[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1 << (bit % 8));
}

/// Overwrites `bits` bits from position `first`, and corrects the checksum.
void Overwrite(Packet* packet, int first, int bits, unsigned code) {
  for (int i = 0; i < bits; ++i) {
    const int bit = first + i;
    auto& byte = (*packet)[static_cast<std::size_t>(bit / 8)];
    byte =
        static_cast<std::uint8_t>((byte & ~(1 << (bit % 8))) | (((code >> i) & 1u) << (bit % 8)));
  }
  Seal(packet);
}

TEST(PacketRefusal, EveryDamageOfOneOrTwoBitsIsRefused) {
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

TEST(PacketRefusal, EveryBurstOfUpToEightBitsIsRefused) {
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

TEST(PacketRefusal, WrongSizesAndConstantBytesAreRefused) {
  const PacketCodec codec(TestScenario());
  std::vector<std::uint8_t> data(64, 0);
  for (std::size_t size : {0u, 1u, 31u, 33u, 64u}) {
    EXPECT_THROW(codec.Decode(data.data(), size, kSecond), UserError) << size;
  }
  EXPECT_THROW(codec.Decode(data.data(), 32, kSecond), UserError);
  data.assign(64, 0xFF);
  EXPECT_THROW(codec.Decode(data.data(), 32, kSecond), UserError);
}

TEST(PacketRefusal, ForeignVersionsIndicesAndCodesAreRefusedEvenWithAValidChecksum) {
  const PacketCodec codec(TestScenario());
  const Packet intact = codec.Encode(Example());
  const auto refused = [&](int first, int bits, unsigned code) {
    Packet p = intact;
    Overwrite(&p, first, bits, code);
    EXPECT_THROW(codec.Decode(p.data(), p.size(), 10 * kSecond), UserError) << first;
  };
  refused(0, 4, 2);         // version
  refused(4, 8, 7);         // source; there are 7 AUVs
  refused(28, 15, 0x7FFF);  // a position code that means nothing
  refused(73, 12, 0xFFF);   // a velocity code that means nothing
  refused(141, 6, 3);       // target; there are 3
  Packet p = intact;
  Overwrite(&p, 4, 8, 6);
  EXPECT_EQ(codec.Decode(p.data(), p.size(), 10 * kSecond).source, 6);
}

TEST(PacketRefusal, NonFiniteAndImpossibleValuesAreABug) {
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

TEST(PacketRefusal, ScenariosThatDoNotFitTheLayoutAreRefused) {
  AgentModel s;
  s.run.agents = 256;
  s.target.count = 64;
  EXPECT_NO_THROW(PacketCodec{s});
  s.run.agents = 257;
  EXPECT_THROW(PacketCodec{s}, UserError);
  s.run.agents = 4;
  s.target.count = 65;
  EXPECT_THROW(PacketCodec{s}, UserError);
}

}  // namespace
}  // namespace stg::agent

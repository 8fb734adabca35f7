#include <cmath>

#include "network_fixture.hpp"

/// Half-duplex, collisions, capture and interference of parts of packets, in cases with a result by
/// hand.
namespace stg::acoustics {
namespace {

TEST(HalfDuplex, WhoSendsHearsNothingThatBegins) {
  Bench b(2);
  b.medium->SetDelay(0, 1, 0.5);
  // The packet of node 0 is at node 1 from 1.5 to 2.5 s.
  // The packet of node 1 leaves until 2.2 s.
  b.Play({{0, 1.0}, {1, 1.2}});
  EXPECT_EQ(b.log.Of(0, 1).reason, DropReason::kHalfDuplex);
  EXPECT_EQ(b.log.Of(1, 0).reason, DropReason::kHalfDuplex) << "from 1.7, node 0 sends until 2.0";
}

TEST(HalfDuplex, OwnTransmissionAbortsAReception) {
  Bench b(2);
  b.medium->SetDelay(0, 1, 0.5);
  // The packet of node 0 is at node 1 from 1.5 to 2.5 s.
  // The packet of node 1 is at node 0 from 2.9 s on.
  b.Play({{0, 1.0}, {1, 2.4}});
  const PacketFate lost = b.log.Of(0, 1);
  EXPECT_EQ(lost.reason, DropReason::kHalfDuplex);
  EXPECT_EQ(lost.begin, Ns(1.5));
  EXPECT_EQ(b.log.Of(1, 0).reason, DropReason::kNone) << "node 0 has sent by 2.0";
}

TEST(HalfDuplex, ATransmissionAtTheVeryEndOfAReceptionCostsNothing) {
  Bench b(2);
  b.medium->SetDelay(0, 1, 0.5);
  b.Play({{0, 1.0}, {1, 2.5}});
  EXPECT_EQ(b.log.Of(0, 1).reason, DropReason::kNone);
  EXPECT_EQ(b.log.Of(0, 1).arrival, Ns(2.5));
}

TEST(Collision, IsWhereBothArriveTogetherAndNowhereElse) {
  Bench b(4);  // 0 and 1 send together; 2 is in the middle, 3 far beyond 1
  b.medium->SetDelay(0, 2, 1.0);
  b.medium->SetDelay(1, 2, 1.0);
  b.medium->SetDelay(0, 3, 4.0);
  b.medium->SetDelay(1, 3, 2.0);
  b.Play({{0, 1.0}, {1, 1.0}});
  EXPECT_EQ(b.log.Of(0, 2).reason, DropReason::kCollision);
  EXPECT_EQ(b.log.Of(1, 2).reason, DropReason::kCollision);
  EXPECT_EQ(b.log.Of(0, 3).reason, DropReason::kNone);
  EXPECT_EQ(b.log.Of(1, 3).reason, DropReason::kNone);
}

TEST(Collision, OfTwoThatBeginTogetherTheStrongerIsAcquiredWhateverItsNumber) {
  for (const int strong : {0, 1}) {
    Bench b(3);
    b.medium->SetLevel(strong, 2, 60.0);
    b.medium->SetLevel(1 - strong, 2, 30.0);
    b.Play({{0, 1.0}, {1, 1.0}});
    EXPECT_EQ(b.log.Of(strong, 2).reason, DropReason::kNone);
    EXPECT_EQ(b.log.Of(1 - strong, 2).reason, DropReason::kCollision);
  }
}

TEST(Capture, TheFirstThatWasAcquiredIsKeptAgainstAWeakerOne) {
  Bench b(3);
  b.medium->SetLevel(0, 2, 40.0);
  b.medium->SetLevel(1, 2, 10.0);
  b.Play({{0, 1.0}, {1, 1.5}});
  const PacketFate kept = b.log.Of(0, 2);
  EXPECT_EQ(kept.reason, DropReason::kNone);
  // The noise has power 1. The other packet adds 10 for half of this packet.
  EXPECT_NEAR(kept.sinr_db, 40.0 - 10.0 * std::log10(1.0 + 0.5 * 10.0), 1e-9);
  EXPECT_EQ(b.log.Of(1, 2).reason, DropReason::kCollision) << "the receiver is busy";
}

TEST(Capture, AStrongerOneThatComesLaterDestroysTheFirstAndIsLostToo) {
  Bench b(3);
  b.medium->SetLevel(0, 2, 40.0);
  b.medium->SetLevel(1, 2, 50.0);
  b.Play({{0, 1.0}, {1, 1.5}});
  EXPECT_EQ(b.log.Of(0, 2).reason, DropReason::kCollision);
  EXPECT_EQ(b.log.Of(1, 2).reason, DropReason::kCollision);
}

/// Exponent of the success of a whole packet at this ratio of powers.
double Exponent(double ratio) {
  return -std::log(2.0) * std::pow(10.0, (10.0 - 10.0 * std::log10(ratio)) / 1.5);
}

TEST(Interference, ExponentsOfPiecesAddUp) {
  Bench b(4);
  // Powers at node 3: 100 of the packet, 9 and 4 of the two others, 1 of the noise.
  b.medium->SetLevel(0, 3, 20.0);
  b.medium->SetLevel(1, 3, 10.0 * std::log10(9.0));
  b.medium->SetLevel(2, 3, 10.0 * std::log10(4.0));
  // The packet of node 1 is there for the second half of the packet, and
  // the packet of node 2 for its last quarter.
  b.Play({{0, 1.0}, {1, 1.5}, {2, 1.75}});
  const double expected = 1.0 - std::exp(0.5 * Exponent(100.0) + 0.25 * Exponent(100.0 / 10.0) +
                                         0.25 * Exponent(100.0 / 14.0));
  EXPECT_NEAR(b.log.Of(0, 3).loss_probability, expected, 1e-12);
  EXPECT_GT(expected, 0.3);
}

TEST(Interference, APacketThatIsGrazedIsNotAsLostAsOneThatIsCovered) {
  const auto loss = [](double begin) {
    Bench b(3);
    b.medium->SetLevel(0, 2, 20.0);
    b.medium->SetLevel(1, 2, 10.0 * std::log10(9.0));
    b.Play({{0, 1.0}, {1, begin}});
    return b.log.Of(0, 2).loss_probability;
  };
  EXPECT_NEAR(loss(1.9), 1.0 - std::pow(2.0, -0.1), 1e-6);
  EXPECT_NEAR(loss(1.5), 1.0 - std::pow(2.0, -0.5), 1e-6);
  EXPECT_NEAR(loss(2.0), 0.0, 1e-6) << "they only touch";
}

TEST(Interference, ABurstThatBeginsWithinAPacketCountsFromThere) {
  Bench b(2);
  b.medium->SetLevel(0, 1, 20.0);
  b.medium->burst_begin = Ns(1.6);
  b.medium->burst_end = Ns(1.8);
  b.medium->burst_db = 10.0;
  b.Play({{0, 1.0}});
  EXPECT_NEAR(b.log.Of(0, 1).loss_probability,
              1.0 - std::exp(0.8 * Exponent(100.0) + 0.2 * Exponent(10.0)), 1e-12);
}

TEST(Interference, OfTheSameWaveformIsNotSpreadIntoNoise) {
  // Two packets have equal levels far above the noise. None survives, whatever the profile.
  for (const std::string& name : ModemProfiles().Names()) {
    if (name == "ideal") continue;
    Bench b(3);
    b.config.physical.modem.profile = name;
    b.medium->SetLevel(0, 2, 60.0);
    b.medium->SetLevel(1, 2, 60.0);
    b.Start();
    b.Offer(0, 1.0);
    b.Offer(1, 1.001);
    b.network->Advance(100 * kSecond);
    EXPECT_GT(b.log.Of(0, 2).loss_probability, 0.99) << name;
    EXPECT_EQ(b.log.Of(0, 2).reason, DropReason::kCollision) << name;
    EXPECT_EQ(b.log.Of(1, 2).reason, DropReason::kCollision) << name;
  }
}

/// The fate of a single packet on a link with these levels.
DropReason Reason(double level_db, double steady_db, double clear_db, double burst_db = 0.0) {
  Bench b(2);
  Hearing& h = b.medium->link(0, 1);
  h.level_db = level_db;
  h.steady_level_db = steady_db;
  h.clear_level_db = clear_db;
  if (burst_db > 0.0) {
    b.medium->burst_begin = 0;
    b.medium->burst_end = 100 * kSecond;
    b.medium->burst_db = burst_db;
  }
  b.Play({{0, 1.0}});
  return b.log.Of(0, 1).reason;
}

TEST(Reasons, NameWhatWouldHaveSavedThePacket) {
  EXPECT_EQ(Reason(60.0, 60.0, 60.0), DropReason::kNone);
  // These are too weak for acquisition, which needs 3 dB.
  EXPECT_EQ(Reason(2.0, 2.0, 2.0), DropReason::kNotAcquired);
  EXPECT_EQ(Reason(2.0, 8.0, 8.0), DropReason::kFading);
  EXPECT_EQ(Reason(2.0, 2.0, 8.0), DropReason::kShadow);
  EXPECT_EQ(Reason(60.0, 60.0, 60.0, 59.0), DropReason::kBurst);
  // These are acquired, but garbled: below 6 dB no packet survives.
  EXPECT_EQ(Reason(4.0, 4.0, 4.0), DropReason::kLoss);
  EXPECT_EQ(Reason(4.0, 60.0, 60.0), DropReason::kFading);
  EXPECT_EQ(Reason(4.0, 4.0, 60.0), DropReason::kShadow);
  EXPECT_EQ(Reason(60.0, 60.0, 60.0, 56.0), DropReason::kBurst);
  // These are not even noise.
  EXPECT_EQ(Reason(-40.0, -40.0, -40.0), DropReason::kRange);
  EXPECT_EQ(Reason(-40.0, 8.0, 8.0), DropReason::kFading);
  EXPECT_EQ(Reason(-40.0, -40.0, 8.0), DropReason::kShadow);
}

TEST(Reasons, AShareOfPacketsIsLostAsTheirProbabilitySays) {
  Bench b(2);
  b.medium->SetLevel(0, 1, 10.0);
  b.Start();
  constexpr int kPackets = 4000;
  int lost = 0;
  for (int k = 0; k < kPackets; ++k) b.Offer(0, 2.0 * k);
  b.network->Advance(Ns(2.0 * kPackets));
  for (const Log::Fate& f : b.log.fates) {
    EXPECT_NEAR(f.fate.loss_probability, 0.5, 1e-9);
    if (f.fate.reason == DropReason::kLoss) ++lost;
  }
  EXPECT_NEAR(lost, 0.5 * kPackets, 4.5 * std::sqrt(0.25 * kPackets));
}

TEST(Waveforms, AreUnderstoodByTheirOwnKindAndNoiseToOthers) {
  Bench b(3);
  b.config.physical.modem.profiles = {"second", "second", "micromodem_fsk_r0"};  // 20 to 24 kHz
  b.medium->SetLevel(0, 1, 20.0);
  b.medium->SetLevel(2, 1, 15.0);
  b.config.physical.modem.packet_bytes = 32;
  b.Play({{2, 0.5}, {0, 1.0}});
  EXPECT_EQ(b.log.Of(2, 1).reason, DropReason::kNotAcquired);
  EXPECT_EQ(b.log.Of(2, 0).reason, DropReason::kNotAcquired);
  // Of its band, 22.5 to 24 kHz fall into the band of the packet, 1.5 of 4 kHz.
  const double interference = 0.375 * std::pow(10.0, 1.5);
  EXPECT_NEAR(b.log.Of(0, 1).sinr_db, 20.0 - 10.0 * std::log10(1.0 + interference), 1e-9);
}

}  // namespace
}  // namespace stg::acoustics

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "acoustic_channel/access/periodic.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "channel_fixture.hpp"

namespace stg::acoustics {
namespace {

NetworkConfig Slotted(int nodes, double transmit_period_s, int decision_steps = 1) {
  NetworkConfig s = LosslessNetwork(nodes);
  s.run.time.decision_steps = decision_steps;
  s.channel.periodic.transmit_period_s = transmit_period_s;
  return s;
}

TEST(Periodic, GivesEveryNodeItsSlotForAnySwarmAndPeriod) {
  for (const int nodes : {1, 2, 4, 7, 20, 53}) {
    for (const int decision_steps : {1, 3}) {
      const double dt_s = 0.1 * decision_steps;
      // Periods in decisions. The channel rounds the ones that are not whole.
      for (const double period : {1.0, 1.4, 1.6, 2.0, 2.4, 3.0, 4.7, 5.0, 9.6, 10.0, 37.0}) {
        const NetworkConfig s = Slotted(nodes, period * dt_s, decision_steps);
        const int slots = std::max(1, static_cast<int>(std::floor(period + 0.5)));
        Turns turns(s.channel, s.run);
        turns.Reset(3, 1);
        for (int k = 0; k < 3 * slots; ++k) {
          const TimeNs t = k * decision_steps * kDt;
          for (int i = 0; i < nodes; ++i) {
            ASSERT_EQ(turns.Due(i, t), k % slots == i % slots)
                << nodes << " nodes, period " << period << ", decision " << k << ", node " << i;
            if (turns.Due(i, t)) {
              ASSERT_EQ(turns.Start(i, t), t);
            }
          }
        }
      }
    }
  }
}

TEST(Periodic, RoundsHalvesUpAndNeverBelowOneDecision) {
  const auto slots_of = [](double period_s) {
    Turns turns(Slotted(1, period_s).channel, Slotted(1, period_s).run);
    int k = 1;
    while (!turns.Due(0, k * kDt)) ++k;
    return k;
  };
  EXPECT_EQ(slots_of(0.25), 3);
  EXPECT_EQ(slots_of(0.249), 2);
  EXPECT_EQ(slots_of(0.3), 3) << "0.3 / 0.1 is a little below 3";
  EXPECT_EQ(slots_of(0.04), 1);
}

TEST(Periodic, WhoAsksLateOrOftenGetsTheSameSlots) {
  const NetworkConfig s = Slotted(6, 0.4);
  Turns all(s.channel, s.run), late(s.channel, s.run);
  for (int k = 0; k < 40; ++k) {
    for (const int i : {5, 0, 3, 3}) {
      const bool due = all.Due(i, k * kDt);
      if (k < 23) continue;
      EXPECT_EQ(late.Due(i, k * kDt), due);
    }
  }
}

TEST(Periodic, RefusesAPeriodShorterThanADecision) {
  NetworkConfig s;
  s.channel.periodic.transmit_period_s = 0.05;
  const auto violation = config::FindViolation(s);
  ASSERT_TRUE(violation);
  EXPECT_EQ(violation->keys.front(), "channel.periodic.transmit_period_s");
  s.channel.periodic.transmit_period_s = 0.1;
  EXPECT_FALSE(config::FindViolation(s));
}

/// A packet with its bytes in `bytes`, whose first byte is k.
Transmission Numbered(int source, std::uint32_t k, std::vector<std::uint8_t>* bytes) {
  bytes->assign(1 + k % 7, 0);
  bytes->front() = static_cast<std::uint8_t>(k);
  Transmission packet = From(source, k * kDt);
  packet.payload = ViewOf(*bytes);
  return packet;
}

/// Node 0 offers a packet in each of 30 steps, or only in those in which it is due. Returns the
/// receptions of node 1.
std::vector<Reception> Heard(const NetworkConfig& s, Channel* channel, bool only_when_due,
                             std::vector<int>* numbers) {
  std::vector<Reception> all, got;
  std::vector<std::uint8_t> bytes;
  channel->Reset(1, 0);
  for (std::uint32_t k = 0; k < 30; ++k) {
    const TimeNs t = k * kDt;
    std::vector<Transmission> offered;
    if (!only_when_due || channel->Due(0, t)) offered.push_back(Numbered(0, k, &bytes));
    StepAtRest(channel, t, k, std::vector<Vec3<double>>(static_cast<std::size_t>(s.run.agents)),
               offered);
    bytes.assign(1, 255);  // the channel has its own copy of what waits
    got.clear();
    channel->Deliver(1, t + kDt, &got);
    for (const Reception& r : got) {
      numbers->push_back(r.payload.data[0]);
      all.push_back(r);
    }
  }
  return all;
}

TEST(Outbox, ANewerPacketReplacesTheOneThatWaits) {
  const NetworkConfig s = Slotted(3, 0.5);
  const auto channel = MakeChannel(s.channel, s.run);
  std::vector<int> every, due;
  const auto offered_always = Heard(s, channel.get(), false, &every);
  // In each round packets 1 to 4 waited and were replaced. Each counts twice, once per receiver.
  EXPECT_EQ(channel->totals().drops[static_cast<std::size_t>(DropReason::kQueue)], 2u * 23u)
      << "30 offered, 6 sent, one waits";
  const auto offered_when_due = Heard(s, channel.get(), true, &due);
  EXPECT_EQ(channel->totals().dropped, 0u);
  EXPECT_EQ(every, (std::vector<int>{0, 5, 10, 15, 20, 25}));
  EXPECT_EQ(due, every) << "to offer only when due changes nothing of what arrives";
  ASSERT_EQ(offered_always.size(), offered_when_due.size());
  for (std::size_t k = 0; k < offered_always.size(); ++k) {
    EXPECT_EQ(offered_always[k].sequence, k) << "counts what left";
    EXPECT_EQ(offered_when_due[k].sequence, k);
    EXPECT_EQ(offered_always[k].generation, offered_when_due[k].generation);
    EXPECT_EQ(offered_always[k].arrival, offered_when_due[k].arrival);
  }
}

TEST(Outbox, APacketWaitsForItsTurnAndKeepsItsGeneration) {
  const NetworkConfig s = Slotted(2, 0.5);
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  const std::vector<Vec3<double>> p(2);
  std::vector<std::uint8_t> bytes;
  std::vector<Reception> got;
  for (std::uint32_t k = 0; k <= 5; ++k) {
    std::vector<Transmission> offered;
    if (k == 2) offered.push_back(Numbered(0, k, &bytes));
    StepAtRest(channel.get(), k * kDt, k, p, offered);
    bytes.assign(1, 255);
    got.clear();
    channel->Deliver(1, (k + 1) * kDt, &got);
    EXPECT_EQ(got.size(), k == 5 ? 1u : 0u) << k;
  }
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].payload.data[0], 2);
  EXPECT_EQ(got[0].payload.size, 3u);
  EXPECT_EQ(got[0].generation, 2 * kDt);
  EXPECT_EQ(got[0].transmit, 5 * kDt);
  // The age counts in the quality: it is 0.3 s, and freshness is 2 s.
  EXPECT_NEAR(got[0].link_quality, std::exp(-0.15), 1e-14);
}

TEST(Outbox, ResetForgetsWhatWaitsAndCountsFromZero) {
  const NetworkConfig s = Slotted(2, 0.5);
  const auto channel = MakeChannel(s.channel, s.run);
  const std::vector<Vec3<double>> p(2);
  channel->Reset(1, 0);
  StepAtRest(channel.get(), 0, 0, p, {From(0, 0)});
  StepAtRest(channel.get(), kDt, 1, p, {From(0, kDt)});  // this one waits
  channel->Reset(1, 1);
  for (std::uint32_t k = 0; k < 6; ++k) {
    StepAtRest(channel.get(), k * kDt, k, p, {});
    EXPECT_TRUE(DeliverAll(channel.get(), (k + 1) * kDt).empty()) << k;
  }
  StepAtRest(channel.get(), 10 * kDt, 10, p, {From(0, 10 * kDt)});
  const auto got = DeliverAll(channel.get(), 11 * kDt);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].sequence, 0u);
}

/// Each node's packets begin to leave in the middle of a step, at a time of the node's own.
class Late : public MediumAccess {
 public:
  explicit Late(const RunConfig& run) : nodes_(run.agents), period_(run.decision_period()) {}
  TimeNs Next(int node, TimeNs from, const Attempt&) const override {
    const TimeNs delay = period_ * (node + 1) / (nodes_ + 1);
    return (from - delay + period_ - 1) / period_ * period_ + delay;
  }

 private:
  int nodes_;
  TimeNs period_;
};

TEST(MediumAccess, OneFromOutsideIsARegisteredName) {
  if (!MediumAccesses().Has("late")) {  // the test may run repeatedly
    MediumAccesses().Add("late", [](const ChannelConfig&, const RunConfig& run) {
      return std::make_unique<Late>(run);
    });
  }
  NetworkConfig s = LosslessNetwork(3);
  s.channel.access = "late";
  s.channel.extended.loss_distance_m = 1e6;
  s.channel.extended.sound_speed_mps = 10.0;
  EXPECT_FALSE(config::FindViolation(s));
  s.channel.periodic.transmit_period_s = 0.01;
  EXPECT_FALSE(config::FindViolation(s)) << "a key of `periodic` binds no other scheme";
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  EXPECT_TRUE(channel->Due(1, kDt));
  StepAtRest(channel.get(), kDt, 1, {{}, {0.5, 0, 0}, {1.0, 0, 0}}, {From(1, kDt)});
  const auto got = DeliverAll(channel.get(), 3 * kDt);
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].transmit, kDt + kDt / 2);
  EXPECT_EQ(got[0].arrival, kDt + kDt / 2 + kDt / 2) << "0.5 m at 10 m/s";
}

TEST(MediumAccess, AnUnknownOneIsRefusedWithTheList) {
  NetworkConfig s;
  s.channel.access = "shouting";
  try {
    MakeChannel(s.channel, s.run);
    FAIL();
  } catch (const UserError& error) {
    EXPECT_EQ(std::string(error.what())
                  .find("unknown medium access 'shouting', expected one of "
                        "periodic"),
              0u)
        << error.what();
  }
  const auto violation = config::FindViolation(s);
  ASSERT_TRUE(violation);
  EXPECT_EQ(violation->keys.front(), "channel.access");
}

}  // namespace
}  // namespace stg::acoustics

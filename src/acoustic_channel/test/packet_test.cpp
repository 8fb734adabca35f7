#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "acoustic_channel/models/extended.hpp"
#include "acoustic_channel/modem/payload_pool.hpp"
#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "channel_fixture.hpp"

namespace stg::acoustics {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes BytesOf(const ByteView& view) { return {view.data, view.data + view.size}; }

/// Random bytes, which differ for every seed.
Bytes RandomBytes(std::size_t size, unsigned seed) {
  std::mt19937 generator(seed);
  Bytes bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(generator());
  return bytes;
}

const std::vector<Vec3<double>> kTriangle = {{0, 0, 0}, {0.3, 0, 0}, {0, 0.4, 0}};

TEST(Payload, BytesOfAnySizeUpToAFrameArriveUnchanged) {
  const NetworkConfig s = LosslessNetwork(3);
  const auto channel = MakeChannel(s.channel, s.run);
  ASSERT_EQ(channel->max_payload(), kLargestFrame);
  channel->Reset(1, 0);
  const std::size_t sizes[] = {1, 2, 31, 32, 33, 255, 256, 1000, kLargestFrame};
  std::uint32_t k = 0;
  for (const std::size_t a : sizes) {
    for (const std::size_t b : sizes) {
      const TimeNs t = k * kDt;
      Bytes first = RandomBytes(a, 2 * k), second = RandomBytes(b, 2 * k + 1);
      const Bytes sent[] = {first, second};
      Transmission packets[] = {From(0, t), From(1, t)};
      packets[0].payload = ViewOf(first);
      packets[1].payload = ViewOf(second);
      StepAtRest(channel.get(), t, k, kTriangle, {packets[0], packets[1]});
      std::fill(first.begin(), first.end(), 0);  // the channel has its own copies
      std::fill(second.begin(), second.end(), 0);
      const auto got = DeliverAll(channel.get(), t + kDt);
      ASSERT_EQ(got.size(), 4u);
      for (const Reception& r : got) EXPECT_EQ(BytesOf(r.payload), sent[r.source]) << a << " " << b;
      ++k;
    }
  }
}

TEST(Payload, IsKeptWhilePacketsAreUnderWayAndAfterDeliveryUntilTheNextStep) {
  NetworkConfig s = LosslessNetwork(3);
  s.channel.extended.sound_speed_mps = 1.0;  // a packet takes three and four steps to the receivers
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  std::vector<Bytes> sent;
  std::vector<Reception> got;
  int delivered = 0;
  for (std::uint32_t k = 0; k < 60; ++k) {
    const TimeNs t = k * kDt;
    sent.push_back(RandomBytes(1 + k % 50, k));
    Transmission packet = From(0, t);
    packet.payload = ViewOf(sent.back());
    StepAtRest(channel.get(), t, k, kTriangle, {packet});
    got.clear();
    channel->Deliver(1, t + kDt, &got);
    channel->Deliver(2, t + kDt, &got);
    for (const Reception& r : got) {
      EXPECT_EQ(BytesOf(r.payload), sent[r.sequence]);
      EXPECT_EQ(r.sequence, k - (r.receiver == 1 ? 2 : 3));
      ++delivered;
    }
  }
  EXPECT_EQ(delivered, 58 + 57);
}

TEST(Payload, PoolUsesASlotAgainOnlyWhenNobodyHoldsIt) {
  PayloadPool pool;
  const Bytes a = RandomBytes(10, 1), b = RandomBytes(20, 2), c = RandomBytes(5, 3);
  const int x = pool.Store(ViewOf(a));
  pool.Hold(x);
  pool.Hold(x);
  const int y = pool.Store(ViewOf(b));
  pool.Hold(y);
  EXPECT_NE(x, y);
  pool.Release(x);
  pool.Release(y);
  EXPECT_EQ(BytesOf(pool.at(y)), b) << "readable until Recycle";
  pool.Recycle();
  const int z = pool.Store(ViewOf(c));
  EXPECT_EQ(z, y);
  EXPECT_EQ(BytesOf(pool.at(z)), c);
  EXPECT_EQ(BytesOf(pool.at(x)), a) << "one receiver to go";
  pool.Clear();
  const int first = pool.Store(ViewOf(a)), second = pool.Store(ViewOf(b));
  EXPECT_EQ(std::min(first, second), std::min(x, y)) << "all slots are free after Clear";
  EXPECT_EQ(std::max(first, second), std::max(x, y));
}

TEST(Destination, AnAddressedPacketReachesThatNodeOnly) {
  const NetworkConfig s = LosslessNetwork(3);
  const auto channel = MakeChannel(s.channel, s.run);
  for (int destination = 0; destination < 3; ++destination) {
    channel->Reset(1, 0);
    Transmission packet = From((destination + 1) % 3, 0);
    packet.destination = destination;
    StepAtRest(channel.get(), 0, 0, kTriangle, {packet});
    const auto got = DeliverAll(channel.get(), kDt);
    ASSERT_EQ(got.size(), 1u);
    EXPECT_EQ(got[0].receiver, destination);
    EXPECT_EQ(got[0].destination, destination);
    EXPECT_EQ(channel->totals().delivered, 1u);
    EXPECT_EQ(channel->totals().dropped, 0u) << "a node that is not meant loses nothing";
  }
}

TEST(Destination, DoesNotChangeWhetherAPacketArrives) {
  // A link has the same losses, whether the packet is also for other nodes or not.
  NetworkConfig s = LosslessNetwork(3);
  s.channel.extended.loss_probability = 0.4;
  const auto channel = MakeChannel(s.channel, s.run);
  const auto arrivals = [&](int destination) {
    std::vector<std::uint32_t> arrived;
    channel->Reset(8, 0);
    for (std::uint32_t k = 0; k < 300; ++k) {
      Transmission packet = From(0, k * kDt);
      packet.destination = destination;
      StepAtRest(channel.get(), k * kDt, k, kTriangle, {packet});
      for (const Reception& r : DeliverAll(channel.get(), (k + 1) * kDt)) {
        if (r.receiver == 2) arrived.push_back(r.sequence);
      }
    }
    return arrived;
  };
  const auto to_all = arrivals(kToAll);
  EXPECT_GT(to_all.size(), 100u);
  EXPECT_LT(to_all.size(), 250u);
  EXPECT_EQ(arrivals(2), to_all);
}

std::string Refusal(const Channel& channel, const Transmission& packet) {
  try {
    channel.CheckOrThrow(packet);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(PacketCheck, RefusesWhatNoModemTakes) {
  const NetworkConfig s = LosslessNetwork(3);
  const auto channel = MakeChannel(s.channel, s.run);
  const Transmission good = From(2, kDt);
  EXPECT_EQ(Refusal(*channel, good), "");
  Transmission p = good;
  p.destination = 1;
  EXPECT_EQ(Refusal(*channel, p), "");
  for (const int destination : {3, -2, 2, 1'000'000}) {
    p.destination = destination;
    EXPECT_EQ(Refusal(*channel, p), "packet: destination " + std::to_string(destination) +
                                        " is neither another node nor all nodes, for source 2");
  }
  p = good;
  for (const int source : {-1, 3}) {
    p.source = source;
    EXPECT_EQ(Refusal(*channel, p), "packet: source " + std::to_string(source) + " does not exist");
  }
  p = good;
  const Bytes frame(kLargestFrame + 1, 1);
  p.payload = {frame.data(), kLargestFrame};
  EXPECT_EQ(Refusal(*channel, p), "");
  p.payload = ViewOf(frame);
  EXPECT_EQ(Refusal(*channel, p), "packet: 2049 bytes of payload, a frame takes 1 to 2048");
  p.payload.size = 0;
  EXPECT_EQ(Refusal(*channel, p), "packet: 0 bytes of payload, a frame takes 1 to 2048");
  p = good;
  p.generation = p.stamp + 1;
  EXPECT_EQ(Refusal(*channel, p),
            "packet: its generation time is later than the time at which it is offered");
}

TEST(Doppler, IsTheClosingSpeedAlongTheLine) {
  const NetworkConfig s = LosslessNetwork(4);
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  // One receiver is ahead, one abeam, one at the place of the sender. The sender moves at 2 m/s
  // along x.
  const std::vector<Vec3<double>> p = {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 0}};
  const std::vector<Vec3<double>> v = {{2, 0, 0}, {0.5, 7, 0}, {0, -0.25, 0}, {-9, 0, 0}};
  channel->Step(0, 0, p, v, {From(0, 0)});
  const auto got = DeliverAll(channel.get(), kDt);
  ASSERT_EQ(got.size(), 3u);
  EXPECT_DOUBLE_EQ(got[0].doppler_mps, 1.5) << "the sender catches up";
  EXPECT_DOUBLE_EQ(got[1].doppler_mps, 0.25) << "the receiver comes; moving across does not count";
  EXPECT_EQ(got[2].doppler_mps, 0.0) << "no line to close along";
}

TEST(Doppler, IsTheDecreaseOfDistanceAndTheSameInBothDirections) {
  const NetworkConfig s = LosslessNetwork(2);
  const auto channel = MakeChannel(s.channel, s.run);
  const std::vector<Vec3<double>> p = {{0.1, -0.4, 0.3}, {-0.7, 0.9, -0.2}};
  const std::vector<Vec3<double>> v = {{0.3, 0.8, -0.1}, {-0.2, 0.4, 0.6}};
  channel->Reset(1, 0);
  channel->Step(0, 0, p, v, {From(0, 0), From(1, 0)});
  const auto got = DeliverAll(channel.get(), kDt);
  ASSERT_EQ(got.size(), 2u);
  const double h = 1e-6;
  const double rate = (Norm(p[1] - p[0] + (v[1] - v[0]) * h) - Norm(p[1] - p[0])) / h;
  EXPECT_NEAR(got[0].doppler_mps, -rate, 1e-6);
  EXPECT_NE(got[0].doppler_mps, 0.0);
  EXPECT_EQ(got[0].doppler_mps, got[1].doppler_mps);
}

TEST(Doppler, NonFiniteVelocitiesAreRefused) {
  const NetworkConfig s = LosslessNetwork(2);
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(0, 0);
  EXPECT_THROW(channel->Step(0, 0, {{}, {}}, {{}, {0, 0, std::nan("")}}, {}),
               std::invalid_argument);
}

TEST(Draws, AreKeyedBySeedEpisodeStepAndLink) {
  NetworkConfig s = LosslessNetwork(3);
  s.channel.extended.loss_probability = 0.3;
  s.channel.extended.loss_distance_m = 0.8;
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(77, 5);
  int lost = 0;
  for (std::uint32_t k = 0; k < 200; ++k) {
    const TimeNs t = k * kDt;
    StepAtRest(channel.get(), t, k, kTriangle, {From(0, t), From(1, t), From(2, t)});
    const auto got = DeliverAll(channel.get(), t + kDt);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (i == j) continue;
        const double d =
            Norm(kTriangle[static_cast<std::size_t>(j)] - kTriangle[static_cast<std::size_t>(i)]);
        Random random(77, Stream::kChannel, 5, k, static_cast<std::uint32_t>(3 * i + j));
        const bool arrives = random.Uniform() >= LossProbability(d, s.channel.extended);
        const bool arrived = std::any_of(got.begin(), got.end(), [&](const Reception& r) {
          return r.source == i && r.receiver == j;
        });
        ASSERT_EQ(arrived, arrives) << k << ": " << i << " to " << j;
        if (!arrives) ++lost;
      }
    }
  }
  EXPECT_GT(lost, 100);
}

}  // namespace
}  // namespace stg::acoustics

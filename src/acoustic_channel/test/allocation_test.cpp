#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "channel_fixture.hpp"

namespace {
long g_allocations = 0;
}  // namespace

// Not inlined: the compiler would otherwise see malloc paired with delete and warn.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++g_allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
// std::stable_sort, which other tests of this program use, allocates with this one.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++g_allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace stg::acoustics {
namespace {

TEST(Allocation, TheCounterCounts) {
  const long before = g_allocations;
  std::vector<int> v(10);
  EXPECT_EQ(g_allocations - before, 1);
}

/// Steps of an episode in which node i sends 1 to 200 bytes, each time another number of them.
/// @param always every node offers a packet in every step; else it offers one only when it is due
struct Traffic {
  Traffic(Channel* channel, bool always)
      : channel(channel),
        always(always),
        p_W(static_cast<std::size_t>(channel->nodes())),
        v_W(p_W) {}

  void Fly(std::uint32_t episode) {
    channel->Reset(3, episode);
    for (std::uint32_t k = 0; k < 100; ++k) {
      const TimeNs t = k * kDt;
      offered.clear();
      for (int i = 0; i < channel->nodes(); ++i) {
        p_W[static_cast<std::size_t>(i)] = {0.02 * i, 0.001 * k, 0.0};
        if (!always && !channel->Due(i, t)) continue;
        Transmission packet;
        packet.source = i;
        packet.stamp = packet.generation = t;
        packet.payload = {bytes.data(), 1 + (31 * k + 17 * static_cast<std::uint32_t>(i)) % 200};
        offered.push_back(packet);
      }
      channel->Step(t, k, p_W, v_W, offered);
      for (int j = 0; j < channel->nodes(); ++j) {
        got.clear();
        channel->Deliver(j, t + kDt, &got);
        for (const Reception& r : got) checksum += r.payload.data[r.payload.size - 1];
      }
    }
    delivered += channel->totals().delivered;
    dropped += channel->totals().dropped;
  }

  Channel* channel;
  bool always;
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(200, 1);
  std::vector<Vec3<double>> p_W, v_W;
  std::vector<Transmission> offered;
  std::vector<Reception> got;
  std::uint64_t delivered = 0, dropped = 0, checksum = 0;
};

TEST(Allocation, ChannelAllocatesNothingAfterWarmUp) {
  for (const char* model : {"range", "extended"}) {
    for (const int agents : {4, 21}) {
      for (const bool always : {false, true}) {
        NetworkConfig s;
        s.run.agents = agents;
        s.channel.model = model;
        const auto channel = MakeChannel(s.channel, s.run);
        Traffic traffic(channel.get(), always);
        traffic.Fly(0);
        traffic.Fly(1);
        const long before = g_allocations;
        const std::uint64_t delivered = traffic.delivered;
        for (std::uint32_t episode = 2; episode < 6; ++episode) traffic.Fly(episode);
        EXPECT_EQ(g_allocations, before) << model << ", " << agents << " agents";
        EXPECT_GT(traffic.delivered, delivered);
        EXPECT_GT(traffic.checksum, 0u);
      }
    }
  }
}

TEST(Allocation, PhysicalAllocatesNothingAfterWarmUp) {
  for (const char* access : {"periodic", "tdma", "aloha", "slotted_aloha", "csma"}) {
    for (const bool fifo : {false, true}) {
      NetworkConfig s;
      s.run.agents = 6;
      s.channel.model = "physical";
      s.channel.access = access;
      s.channel.physical.modem.profile = "micromodem_psk_r5";
      if (fifo) s.channel.physical.modem.queue = QueuePolicy::kFifo;
      s.channel.periodic.transmit_period_s = 5.0;
      s.channel.slots.length_s = 0.8;
      s.channel.slots.send_probability = 0.3;
      s.channel.contention.rest_s = 5.0;
      s.channel.physical.noise.burst_every_s = 3.0;
      const auto channel = MakeChannel(s.channel, s.run);
      Traffic traffic(channel.get(), true);
      for (std::uint32_t episode = 0; episode < 16; ++episode) traffic.Fly(episode);
      const long before = g_allocations;
      const std::uint64_t ended = traffic.delivered + traffic.dropped;
      for (std::uint32_t episode = 16; episode < 24; ++episode) traffic.Fly(episode);
      EXPECT_EQ(g_allocations, before) << access;
      EXPECT_GT(traffic.delivered + traffic.dropped, ended + 100) << access;
      EXPECT_GT(traffic.delivered, 0u) << access;
    }
  }
}

}  // namespace
}  // namespace stg::acoustics

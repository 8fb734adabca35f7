#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "acoustic_channel/channel/channel.hpp"

namespace {
long g_allocations = 0;
}  // namespace

// Not inlined: the compiler would otherwise see malloc paired with delete and warn.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++g_allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
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

TEST(Allocation, ChannelAllocatesNothingAfterWarmUp) {
  constexpr TimeNs kDt = 100'000'000;
  for (const ChannelModel model : {ChannelModel::kRange, ChannelModel::kExtended}) {
    for (const int agents : {4, 21}) {
      NetworkConfig s;
      s.agents = agents;
      s.channel.model = model;
      const auto channel = MakeChannel(s.channel, s.agents);
      std::vector<Vec3<double>> p_W(static_cast<std::size_t>(agents));
      std::vector<Transmission> sent;
      std::vector<Reception> got;
      double checksum = 0.0;
      long before = 0;
      std::uint64_t delivered = 0;
      for (std::uint32_t episode = 0; episode < 4; ++episode) {
        if (episode == 1) before = g_allocations;
        channel->Reset(3, episode);
        for (std::uint32_t k = 0; k < 100; ++k) {
          const TimeNs t = k * kDt;
          sent.clear();
          for (int i = 0; i < agents; ++i) {
            auto& p = p_W[static_cast<std::size_t>(i)];
            p = {0.02 * i, 0.001 * k, 0.0};
            if ((static_cast<std::uint32_t>(i) + k) % 5 != 0) continue;
            Transmission packet;
            packet.source = i;
            packet.stamp = packet.generation = t;
            packet.data.fill(static_cast<std::uint8_t>(i + 1));
            sent.push_back(packet);
          }
          channel->Step(t, k, p_W, sent);
          for (int j = 0; j < agents; ++j) {
            got.clear();
            channel->Deliver(j, t + kDt, &got);
            for (const Reception& r : got) {
              checksum += r.data[0];
            }
          }
          checksum += channel->Link(0, 1, t + kDt).average_age_s;
        }
        delivered += channel->totals().delivered;
      }
      EXPECT_EQ(g_allocations, before) << agents << " agents";
      EXPECT_GT(delivered, 0u);
      EXPECT_GT(checksum, 0.0);
    }
  }
}

}  // namespace
}  // namespace stg::acoustics

#include <benchmark/benchmark.h>

#include "acoustic_channel/channel/channel.hpp"

/// Measures the channel as in the vectorised environment: N agents in the medium workspace, dt 0.1
/// s, one packet per agent every 0.5 s (staggered), and all receptions are fetched in every step.
namespace stg::acoustics {
namespace {

constexpr TimeNs kDt = 100'000'000;

void Step(benchmark::State& bench, const char* model) {
  const int agents = static_cast<int>(bench.range(0));
  NetworkConfig s;
  s.run.agents = agents;
  s.channel.model = model;
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  std::vector<Vec3<double>> p_W;
  for (int i = 0; i < agents; ++i) {
    p_W.push_back({0.02 * (i % 7), 0.02 * (i / 7), 0.01 * (i % 3)});
  }
  const std::vector<Vec3<double>> v_W(p_W.size(), {0.1, 0.0, 0.0});
  const std::vector<std::uint8_t> bytes(32, 1);
  std::vector<std::vector<Transmission>> sent(5);
  for (int i = 0; i < agents; ++i) {
    Transmission packet;
    packet.source = i;
    packet.payload = ViewOf(bytes);
    sent[static_cast<std::size_t>(i % 5)].push_back(packet);
  }
  std::vector<Reception> got;
  std::uint32_t k = 0;
  for (auto _ : bench) {
    const TimeNs t = k * kDt;
    auto& now = sent[k % 5];
    for (Transmission& packet : now) packet.stamp = packet.generation = t;
    channel->Step(t, k, p_W, v_W, now);
    for (int j = 0; j < agents; ++j) {
      got.clear();
      channel->Deliver(j, t + kDt, &got);
      benchmark::DoNotOptimize(got.data());
    }
    ++k;
  }
  bench.counters["receptions/step"] =
      static_cast<double>(channel->totals().delivered) / static_cast<double>(k);
}
void RangeStep(benchmark::State& bench) { Step(bench, "range"); }
void ExtendedStep(benchmark::State& bench) { Step(bench, "extended"); }
BENCHMARK(RangeStep)->Arg(4)->Arg(8)->Arg(20)->Arg(50)->Arg(100);
BENCHMARK(ExtendedStep)->Arg(4)->Arg(8)->Arg(20)->Arg(50)->Arg(100);

/// Modems 20 m apart that always have a packet, with one medium access; decisions of 0.1 s.
void Modems(benchmark::State& bench, const char* access) {
  const int agents = static_cast<int>(bench.range(0));
  NetworkConfig s;
  s.run.agents = agents;
  s.channel.model = "physical";
  s.channel.access = access;
  s.channel.physical.modem.packet_bytes = 32;
  s.channel.slots.length_s = 1.25;
  s.channel.contention.rest_s = agents;
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  std::vector<Vec3<double>> p_W;
  for (int i = 0; i < agents; ++i) p_W.push_back({20.0 * (i % 7), 20.0 * (i / 7), -5.0 - i % 3});
  const std::vector<Vec3<double>> v_W(p_W.size(), {0.1, 0.0, 0.0});
  const std::vector<std::uint8_t> bytes(32, 1);
  std::vector<Transmission> offered;
  std::vector<Reception> got;
  std::uint32_t k = 0;
  for (auto _ : bench) {
    const TimeNs t = k * kDt;
    offered.clear();
    for (int i = 0; i < agents; ++i) {
      if (!channel->Due(i, t)) continue;
      Transmission& packet = offered.emplace_back();
      packet.source = i;
      packet.stamp = packet.generation = t;
      packet.payload = ViewOf(bytes);
    }
    channel->Step(t, k, p_W, v_W, offered);
    for (int j = 0; j < agents; ++j) {
      got.clear();
      channel->Deliver(j, t + kDt, &got);
      benchmark::DoNotOptimize(got.data());
    }
    ++k;
  }
  const auto& totals = channel->totals();
  bench.counters["fates/step"] =
      static_cast<double>(totals.delivered + totals.dropped) / static_cast<double>(k);
}
void TdmaStep(benchmark::State& bench) { Modems(bench, "tdma"); }
void CsmaStep(benchmark::State& bench) { Modems(bench, "csma"); }
BENCHMARK(TdmaStep)->Arg(4)->Arg(8)->Arg(20)->Arg(50);
BENCHMARK(CsmaStep)->Arg(4)->Arg(8)->Arg(20)->Arg(50);

void Link(benchmark::State& bench) {
  const NetworkConfig s;
  const auto channel = MakeChannel(s.channel, s.run);
  channel->Reset(1, 0);
  const std::vector<Vec3<double>> origin(4);
  channel->Step(0, 0, origin, origin, {});
  TimeNs now = 0;
  for (auto _ : bench) {
    LinkStatistics link = channel->Link(0, 1, ++now);
    benchmark::DoNotOptimize(link);
  }
}
BENCHMARK(Link);

}  // namespace
}  // namespace stg::acoustics

BENCHMARK_MAIN();

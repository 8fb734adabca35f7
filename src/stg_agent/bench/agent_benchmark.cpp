#include <benchmark/benchmark.h>

#include "../test/agent_fixture.hpp"

/// Nanoseconds per agent and decision: Observe, Act, a detection, and as many packets as
/// arrive on average.
namespace {

using namespace stg;

void Step(benchmark::State& state) {
  Scenario s;
  s.agents = static_cast<int>(state.range(0));
  std::vector<Agent> agents = MakeAgents(s);
  for (Agent& a : agents) a.Reset(0, CueAt({0.1, 0.1, 0.1}));
  const int packets = static_cast<int>(state.range(1));
  std::vector<Reception> air(agents.size());
  std::vector<Vec3<double>> p(agents.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double t = static_cast<double>(i);
    p[i] = {0.3 * std::sin(t), 0.3 * std::cos(t), 0.02 * std::sin(3.0 * t)};
  }
  float observation[74], action[3] = {0.1F, -0.2F, 0.3F};
  const PacketCodec codec(s);
  TimeNs t = 0;
  std::size_t k = 0;
  for (auto _ : state) {
    state.PauseTiming();
    for (std::size_t j = 0; j < agents.size(); ++j) {
      NeighbourState n;
      n.source = static_cast<int>(j);
      n.generation = t;
      n.p_W = p[j];
      n.has_target = true;
      n.target_stamp = t;
      n.p_WT = {0.1, 0.1, 0.1};
      n.target_std = 0.01;
      air[j].data = codec.Encode(n);
      air[j].source = n.source;
      air[j].arrival = t;
    }
    state.ResumeTiming();
    for (std::size_t i = 0; i < agents.size(); ++i) {
      Agent& a = agents[i];
      for (int n = 1; n <= packets; ++n)
        a.Receive(air[(i + k + static_cast<std::size_t>(n)) % air.size()]);
      a.Detect({t, 0, {0.1, 0.1, 0.1}, 0.0});
      NavState nav = Nav(t, p[i], {0.1, 0.0, 0.0});
      a.Observe(nav, observation);
      const AgentOutput out = a.Act(action);
      benchmark::DoNotOptimize(out);
      benchmark::DoNotOptimize(observation);
    }
    t += kStep;
    ++k;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(agents.size()));
  state.counters["ns_per_agent"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * static_cast<double>(agents.size()) * 1e-9,
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
// Swarm size, packets received per agent and decision.
BENCHMARK(Step)->Args({4, 0})->Args({4, 1})->Args({20, 1})->Args({100, 1});

}  // namespace

BENCHMARK_MAIN();

#include <benchmark/benchmark.h>

#include "agent/agent_fixture.hpp"
#include "entities/entity_examples.hpp"
#include "stg_agent/entities/entity_policy.hpp"

/// Measures nanoseconds per agent and decision: Observe, Act, a detection, and the mean number of
/// received packets.
namespace stg::agent {
namespace {

/// Packets are encoded in advance for this number of decisions. Then the episode starts again.
constexpr std::size_t kEpisode = 64;

void Step(benchmark::State& state) {
  AgentModel s;
  s.run.agents = static_cast<int>(state.range(0));
  const int packets = static_cast<int>(state.range(1));
  std::vector<Agent> agents = MakeAgents(s);
  const std::size_t count = agents.size();
  std::vector<Vec3<double>> p(count);
  std::vector<std::vector<HeardPacket>> air(kEpisode, std::vector<HeardPacket>(count));
  for (std::size_t j = 0; j < count; ++j) {
    const double phase = static_cast<double>(j);
    p[j] = {0.3 * std::sin(phase), 0.3 * std::cos(phase), 0.02 * std::sin(3.0 * phase)};
    for (std::size_t k = 0; k < kEpisode; ++k) {
      NeighbourState n;
      n.source = static_cast<int>(j);
      n.generation = static_cast<TimeNs>(k) * kStep;
      n.p_W = p[j];
      n.has_target = true;
      n.target_stamp = n.generation;
      n.p_WT = {0.1, 0.1, 0.1};
      n.target_std = 0.01;
      air[k][j] = Heard(s, n, n.generation);
    }
  }
  float observation[74], action[3] = {0.1F, -0.2F, 0.3F};
  std::size_t k = kEpisode;
  for (auto _ : state) {
    if (k == kEpisode) {
      for (Agent& a : agents) a.Reset(0, CueAt({0.1, 0.1, 0.1}));
      k = 0;
    }
    const TimeNs t = static_cast<TimeNs>(k) * kStep;
    for (std::size_t i = 0; i < count; ++i) {
      Agent& a = agents[i];
      for (int n = 1; n <= packets; ++n) {
        const std::size_t distance = 1 + (k + static_cast<std::size_t>(n)) % (count - 1);
        a.Receive(air[k][(i + distance) % count]);
      }
      a.Detect({t, 0, {0.1, 0.1, 0.1}, 0.0});
      a.Observe(Nav(t, p[i], {0.1, 0.0, 0.0}), observation);
      const AgentOutput out = a.Act(action);
      benchmark::DoNotOptimize(out);
      benchmark::DoNotOptimize(observation);
    }
    ++k;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(agents.size()));
  state.counters["ns_per_agent"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * static_cast<double>(agents.size()) * 1e-9,
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
// Size of the swarm, and packets received per agent and decision.
BENCHMARK(Step)->Args({4, 0})->Args({4, 1})->Args({20, 1})->Args({100, 1});

NeighbourState Overheard(int source, TimeNs t, const Vec3<double>& p) {
  NeighbourState s;
  s.source = source;
  s.generation = t;
  s.p_W = p;
  s.has_target = true;
  s.target_stamp = t;
  s.target_std = 0.01;
  return s;
}

void Encode(benchmark::State& bench) {
  const PacketCodec codec{AgentModel{}};
  NeighbourState state = Overheard(1, 12'300'000'000, {0.1, 0.2, 0.3});
  for (auto _ : bench) {
    benchmark::DoNotOptimize(state);
    Packet packet = codec.Encode(state);
    benchmark::DoNotOptimize(packet);
  }
}
BENCHMARK(Encode);

void Decode(benchmark::State& bench) {
  const PacketCodec codec{AgentModel{}};
  Packet packet = codec.Encode(Overheard(1, 12'300'000'000, {0.1, 0.2, 0.3}));
  for (auto _ : bench) {
    benchmark::DoNotOptimize(packet);
    NeighbourState state = codec.Decode(packet.data(), packet.size(), 12'400'000'000);
    benchmark::DoNotOptimize(state);
  }
}
BENCHMARK(Decode);

/// Measures entities and command of one AUV. @param neighbours that it knows; @param targets rows
void EntityCommand(benchmark::State& bench, EntityNetwork network) {
  const int neighbours = static_cast<int>(bench.range(0)),
            targets = static_cast<int>(bench.range(1));
  EntityPolicy::Parameters p;
  p.network = network;
  p.numbers.assign(EntityParameters(network, 5), 0.01F);
  p.log_std.assign(5, -1.0F);
  const EntityPolicy policy(p);
  const EntityExample example = MakeExample(1, neighbours);
  const EntityInput input = example.input();
  Entities entities;
  float command[5];
  for (auto _ : bench) {
    BuildEntities(input, &entities);
    for (int t = 1; t < targets; ++t) {
      std::copy(entities.target[0], entities.target[0] + kTargetNumbers, entities.target[t]);
      std::copy(entities.edge[0][0], entities.edge[0][0] + kNeighbourRows * kEdgeNumbers,
                entities.edge[t][0]);
    }
    entities.targets = targets;
    policy.Command(entities, command);
    benchmark::DoNotOptimize(command);
  }
}
BENCHMARK_CAPTURE(EntityCommand, pool, EntityNetwork::kPool)
    ->Args({3, 1})
    ->Args({7, 3})
    ->Args({16, 5});
BENCHMARK_CAPTURE(EntityCommand, graph, EntityNetwork::kGraph)
    ->Args({3, 1})
    ->Args({7, 3})
    ->Args({16, 5});

}  // namespace
}  // namespace stg::agent

BENCHMARK_MAIN();

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "env/env_fixture.hpp"
#include "stg_agent/entities/entity_pilot.hpp"

namespace {
std::atomic<long> g_allocations{0};  // other tests of this program have threads

void* Allocate(std::size_t size, std::size_t alignment) {
  ++g_allocations;
  // aligned_alloc wants a multiple of the alignment.
  if (void* p = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)) {
    return p;
  }
  throw std::bad_alloc();
}
}  // namespace

// Not inlined: the compiler would otherwise see malloc paired with delete and warn.
[[gnu::noinline]] void* operator new(std::size_t size) { return Allocate(size, 16); }
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  return Allocate(size, static_cast<std::size_t>(alignment));
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}

namespace stg::env {
namespace {

TEST(Allocation, TheCounterCountsPlainAndAlignedMemory) {
  const long before = g_allocations;
  std::vector<int> v(10);
  std::vector<Pack> p(10);
  EXPECT_EQ(g_allocations - before, 2);
}

/// Counts the allocations of three episodes and their restarts, after a first episode.
long AllocationsAfterWarmUp(Scenario s) {
  VectorEnvOptions o;
  TestEnv env(Short(std::move(s), 60), o);
  env.Reset();
  std::vector<std::vector<float>> actions;
  for (int k = 0; k < 60; ++k) {
    actions.push_back(ActionsOf(env, o));
    env.Step(actions.back());
  }
  const long before = g_allocations;
  for (int k = 0; k < 180; ++k) env.Step(actions[static_cast<size_t>(k) % 60]);
  env.RestartAt(7);
  EXPECT_EQ(env.round(0), 7u);
  return g_allocations - before;
}

TEST(Allocation, StepsAndRestartsAllocateNothingInEitherMode) {
  for (const char* scenario : {"medium", "medium_release"}) {
    for (const char* mode : {"mode=truth", "mode=acoustic"}) {
      for (const char* interface : {"control.interface=velocity3", "control.interface=tau6"}) {
        EXPECT_EQ(AllocationsAfterWarmUp(Shipped(scenario, "nominal", {mode, interface})), 0)
            << scenario << " " << mode << " " << interface;
      }
    }
  }
}

TEST(Allocation, NorDoModemsInWater) {
  for (const char* access : {"tdma", "csma", "slotted_aloha"}) {
    EXPECT_EQ(AllocationsAfterWarmUp(
                  Shipped("physical", "nominal",
                          {std::string("channel.access=") + access, "time.decision_steps=10"})),
              0)
        << access;
  }
}

TEST(Allocation, NorDoDriftingAuvsThatShareMeasurements) {
  EXPECT_EQ(AllocationsAfterWarmUp(Shipped("field", "nominal",
                                           {"navigation.kind=dead_reckoning",
                                            "sensing.sensor=range", "track.filter=measurements"})),
            0);
}

TEST(Allocation, NorDoAuvsThatLocateEachOther) {
  EXPECT_EQ(AllocationsAfterWarmUp(Shipped("deep", "craft")), 0);
}

TEST(Allocation, NorDoUnlabelledDetectionsOfManyTargets) {
  EXPECT_EQ(AllocationsAfterWarmUp(Shipped("utracking", "unlabelled")), 0);
}

TEST(Allocation, NorDoManyAuvsWithNoiseAndMovingTargets) {
  std::vector<std::string> keys{"agents=20",
                                "target.count=3",
                                "target.motion=evasive",
                                "reset.min_separation_m=0.03",
                                "disturbance.force_std_n=1.0",
                                "reward.weights.separation=0.1",
                                "mode=truth"};
  EXPECT_EQ(AllocationsAfterWarmUp(Shipped("hard", "nominal", keys)), 0);
  keys.back() = "mode=acoustic";
  for (const char* key : {"sensing.position.noise_std_m=0.01", "sensing.detection_probability=0.8",
                          "sensing.dropout_rate_hz=0.1"}) {
    keys.emplace_back(key);
  }
  EXPECT_EQ(AllocationsAfterWarmUp(Shipped("hard", "nominal", keys)), 0);
}

TEST(Allocation, AnAgentsPassThroughAPolicyOverEntitiesTakesNone) {
  TestEnv env(Short(LoadNamedScenario(STG_SCENARIO_FOLDER, "field", "nominal", {"agents=20"}), 60));
  env.Reset();
  const agent::AgentView view = env.agent(0, 3);
  for (const agent::EntityNetwork network :
       {agent::EntityNetwork::kPool, agent::EntityNetwork::kGraph}) {
    agent::EntityPolicy::Parameters p;
    p.network = network;
    p.numbers.assign(agent::EntityParameters(network, 5), 0.01F);
    p.log_std.assign(5, -1.0F);
    const agent::EntityPolicy policy(p);
    view.memory().commanded = false;  // a new command is due
    float action[dynamics::kMaxActionSize];
    const long before = g_allocations;
    agent::Fly(policy, view, action);
    EXPECT_EQ(g_allocations - before, 0);
  }
}

}  // namespace
}  // namespace stg::env

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <new>

#include "agent/agent_fixture.hpp"

namespace {
bool counting = false;
long allocations = 0;
}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
  if (counting) ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace stg::agent {
namespace {

/// The observations of a whole episode in a row. The outputs go to `outputs`.
std::vector<float> RunEpisode(Agent* agent, const std::vector<Input>& inputs,
                              std::vector<AgentOutput>* outputs = nullptr) {
  std::vector<float> all, observation;
  for (const Input& in : inputs) {
    const AgentOutput out = Drive(agent, in, &observation);
    if (outputs) outputs->push_back(out);
    all.insert(all.end(), observation.begin(), observation.end());
  }
  return all;
}

void ExpectSame(const std::vector<AgentOutput>& a, const std::vector<AgentOutput>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].cmd_vel_W.x, b[k].cmd_vel_W.x);
    for (int n = 0; n < 6; ++n) EXPECT_EQ(a[k].fraction[n], b[k].fraction[n]);
  }
}

TEST(AgentProperty, UsedThenResetEqualsFresh) {
  const AgentModel s;
  const auto inputs = RandomEpisode(s, 2, 200, 11);
  Agent fresh(s, 2), used(s, 2);
  RunEpisode(&used, RandomEpisode(s, 2, 137, 5));
  std::vector<AgentOutput> a, b;
  fresh.Reset(4, CueAt({0.1, 0.2, 0.3}));
  used.Reset(4, CueAt({0.1, 0.2, 0.3}));
  EXPECT_EQ(RunEpisode(&fresh, inputs, &a), RunEpisode(&used, inputs, &b));
  ExpectSame(a, b);
}

TEST(AgentProperty, OrderOfMessagesWithinAStepDoesNotMatter) {
  const AgentModel s;
  auto inputs = RandomEpisode(s, 0, 200, 21);
  Agent a(s, 0), b(s, 0);
  a.Reset(0, CueAt({}));
  b.Reset(0, CueAt({}));
  std::vector<float> x, y;
  for (Input& in : inputs) {
    Drive(&a, in, &x);
    for (const dynamics::Detection& d : in.detections) b.Detect(d);
    std::reverse(in.receptions.begin(), in.receptions.end());
    in.detections.clear();
    Drive(&b, in, &y);
    ASSERT_EQ(x, y);
  }
}

TEST(AgentProperty, ObservationsAreFiniteAndWithinTheirBounds) {
  for (const int agents : {1, 2, 4, 9}) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      AgentModel s;
      s.run.agents = agents;
      Agent agent(s, 0);
      agent.Reset(0, CueAt({0.9, -0.9, 0.9}, 0.5));
      std::vector<float> o;
      for (const Input& in : RandomEpisode(s, 0, 100, seed, {}, 1.0)) {
        const AgentOutput out = Drive(&agent, in, &o);
        ASSERT_EQ(o.size(), 74U);
        for (std::size_t k = 0; k < o.size(); ++k) {
          // Positions, offsets, relative velocities and normalised d and e are clipped at 2. All
          // other features are fractions, except the target's speed, which only physics bounds.
          if (k >= 30 && k < 33) {
            ASSERT_TRUE(std::isfinite(o[k]));
            continue;
          }
          const bool wide =
              k < 3 || (k >= 15 && k < 27) || (k >= 33 && k < 42) || k == 51 || k == 52 || k == 55;
          ASSERT_LE(std::abs(o[k]), (wide ? 2.0F : 1.0F) + 1e-6F) << k;
        }
        for (const double f : out.fraction) ASSERT_LE(std::abs(f), 1.0);
        ASSERT_EQ(o[59] + o[60] + o[61] + o[62], 1.0F);
        ASSERT_EQ(o[63] + o[64] + o[65] + o[66], 1.0F);
      }
    }
  }
}

TEST(AgentProperty, TranslatingTheWorldChangesOnlyPositionAndWallFeatures) {
  const AgentModel s;
  // The shift is a multiple of the packet's position steps, so that packets round alike.
  const auto fields = PacketCodec(s).fields();
  const double resolution = fields[0].resolution;
  ASSERT_DOUBLE_EQ(resolution, fields[5].resolution);
  const Vec3<double> shift{1000 * resolution, -2000 * resolution, 3000 * resolution};
  Agent here(s, 1), there(s, 1);
  here.Reset(0, CueAt({0.1, 0.1, 0.1}));
  there.Reset(0, CueAt(Vec3<double>{0.1, 0.1, 0.1} + shift));
  // The AUVs stay in the middle, so dead reckoning meets no wall before a neighbour reports again.
  const auto a = RandomEpisode(s, 1, 200, 31, {}, 0.2);
  const auto b = RandomEpisode(s, 1, 200, 31, shift, 0.2);
  std::vector<float> x, y;
  int compared = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    Drive(&here, a[k], &x);
    Drive(&there, b[k], &y);
    for (std::size_t j = 0; j < x.size(); ++j) {
      if (j < 3 || (j >= 27 && j < 30)) continue;
      ASSERT_NEAR(x[j], y[j], 2e-5) << "step " << k << " feature " << j;
      ++compared;
    }
    ASSERT_NE(x[0], y[0]);
  }
  EXPECT_EQ(compared, 200 * 68);
}

TEST(AgentProperty, NearestOrderDoesNotDependOnTheNeighboursIndices) {
  AgentModel s;
  s.run.agents = 6;
  const int permutation[] = {0, 4, 5, 1, 3, 2};
  // There are no target estimates, because the order in which they are fused changes the result.
  const auto inputs = RandomEpisode(s, 0, 200, 41, {}, 0.9, false);
  Agent a(s, 0), b(s, 0);
  a.Reset(0, CueAt({}));
  b.Reset(0, CueAt({}));
  const PacketCodec codec(s);
  std::vector<float> x, y;
  for (Input in : inputs) {
    Drive(&a, in, &x);
    for (HeardPacket& r : in.receptions) {
      NeighbourState n = codec.Decode(r.data.data(), r.data.size(), r.reception.arrival);
      n.source = permutation[n.source];
      r.reception.source = n.source;
      r.data = codec.Encode(n);
    }
    Drive(&b, in, &y);
    // Sums over neighbours run in another order, so they are equal up to rounding.
    for (std::size_t k = 0; k < x.size(); ++k) ASSERT_NEAR(x[k], y[k], 1e-6) << k;
  }
}

TEST(AgentProperty, AStepAllocatesNothing) {
  for (const int agents : {4, 50}) {
    AgentModel s;
    s.run.agents = agents;
    auto inputs = RandomEpisode(s, 0, 100, 51);
    std::size_t damaged = 20;
    while (inputs[damaged].receptions.empty()) ++damaged;
    inputs[damaged].receptions[0].data[3] ^= 1;
    Agent agent(s, 0);
    std::vector<float> observation(static_cast<std::size_t>(s.observation_size()));
    for (int episode = 0; episode < 2; ++episode) {
      agent.Reset(static_cast<std::uint32_t>(episode), CueAt({}));
      for (const Input& in : inputs) {
        const bool refused = &in == &inputs[damaged];  // the exception allocates memory
        counting = !refused;
        Drive(&agent, in, &observation);
        counting = false;
      }
    }
    EXPECT_EQ(agent.view().refused_packets(), 1U);
  }
  EXPECT_EQ(allocations, 0);
}

TEST(AgentProperty, AgentsThatShareTheScenarioActAlike) {
  const AgentModel s;
  const auto inputs = RandomEpisode(s, 3, 100, 61);
  Agent alone(s, 3);
  std::vector<Agent> agents = MakeAgents(s);
  Agent& shared = agents[3];
  alone.Reset(0, CueAt({}));
  shared.Reset(0, CueAt({}));
  EXPECT_EQ(RunEpisode(&alone, inputs), RunEpisode(&shared, inputs));
}

}  // namespace
}  // namespace stg::agent

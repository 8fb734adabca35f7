#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/algorithms/off_policy/replay_batch.hpp"

namespace stg::learn {
namespace {

constexpr double kGamma = 0.5;
constexpr int kSteps = 4;

/// Two shards of 2 and 1 environments. Every number shows its collection, step and environment. The
/// episodes of environment 2 end with the second step of every collection.
class ReplayTest : public ::testing::Test {
 protected:
  ReplayTest() {
    problem_.agents = 2;
    problem_.observation_size = 1;
  }

  static float Tag(int collection, int step, int env) {
    return static_cast<float>(100 * collection + 10 * step + env);
  }

  void Fill(ReplayBuffer* replay, int number) {
    Collection collection;
    collection.number = static_cast<std::uint32_t>(number);
    collection.steps = kSteps;
    collection.shards = {{0, 2}, {2, 1}};
    replay->Begin(collection);
    for (int shard = 0; shard < 2; ++shard) {
      const int first = collection.shards[static_cast<std::size_t>(shard)].first_env;
      const int envs = collection.shards[static_cast<std::size_t>(shard)].envs;
      for (int t = 0; t < kSteps; ++t) {
        std::vector<float> seen, state, next_seen, next_state, final_seen, final_state, reward,
            rewards;
        std::vector<std::uint8_t> truncated;
        for (int e = first; e < first + envs; ++e) {
          truncated.push_back(e == 2 && t == 1 ? 1 : 0);
          const float now = Tag(number, t, e), next = Tag(number, t + 1, e);
          reward.push_back(now);
          state.push_back(now);
          next_state.push_back(next);
          final_state.push_back(-now);
          for (int agent = 0; agent < 2; ++agent) {
            const float own = 0.25F * static_cast<float>(agent);
            rewards.push_back(now + own);
            seen.push_back(now + own);
            next_seen.push_back(next + own);
            final_seen.push_back(-now - own);
          }
        }
        Transition transition;
        transition.shard = shard;
        transition.step = t;
        transition.envs = envs;
        transition.observations = seen.data();
        transition.states = state.data();
        transition.actions = seen.data();
        transition.rewards = rewards.data();
        transition.team_rewards = reward.data();
        transition.truncated = truncated.data();
        transition.next_observations = next_seen.data();
        transition.next_states = next_state.data();
        transition.final_observations = final_seen.data();
        transition.final_states = final_state.data();
        replay->Add(transition);
      }
    }
  }

  void SaveAndLoad(bool own);

  Problem problem_;
};

TEST_F(ReplayTest, SamplesStopAtEpisodesAndCollectionsAndDiscountWhatTheyHave) {
  ReplayBuffer replay(problem_, 24, 3, kGamma, true);
  Fill(&replay, 1);
  Fill(&replay, 2);
  EXPECT_EQ(replay.size(), 24);
  for (std::size_t chunk = 0; chunk < 2; ++chunk) {
    for (std::size_t shard = 0; shard < 2; ++shard) {
      const int envs = shard == 0 ? 2 : 1;
      for (int t = 0; t < kSteps; ++t) {
        for (int e = 0; e < envs; ++e) {
          const int number = static_cast<int>(chunk) + 1, env = e + (shard == 0 ? 0 : 2);
          const auto s = replay.At({chunk, shard, static_cast<std::size_t>(t * envs + e)});
          EXPECT_EQ(*s.state, Tag(number, t, env));
          EXPECT_EQ(s.observations[1], Tag(number, t, env) + 0.25F);
          EXPECT_EQ(s.actions[1], Tag(number, t, env) + 0.25F);
          const bool cut = env == 2 && t < 2;
          const int last = std::min({t + 2, cut ? 1 : kSteps - 1, kSteps - 1});
          double reward = 0.0, weight = 0.0, power = 1.0;
          for (int k = t; k <= last; ++k, power *= kGamma) {
            reward += power * static_cast<double>(Tag(number, k, env));
            weight += power;
          }
          EXPECT_FLOAT_EQ(s.reward, static_cast<float>(reward));
          EXPECT_FLOAT_EQ(s.weight, static_cast<float>(weight));
          float own[2];
          replay.OwnRewards({chunk, shard, static_cast<std::size_t>(t * envs + e)}, own);
          EXPECT_FLOAT_EQ(own[0], static_cast<float>(reward));
          EXPECT_FLOAT_EQ(own[1], static_cast<float>(reward + 0.25 * weight));
          EXPECT_FLOAT_EQ(s.discount, static_cast<float>(power));
          const float next = cut ? -Tag(number, 1, env) : Tag(number, last + 1, env);
          EXPECT_EQ(*s.next_state, next);
          EXPECT_EQ(s.next_observations[0], next);
        }
      }
    }
  }
}

TEST_F(ReplayTest, ForgetsTheOldestCollectionAndDrawsEveryStep) {
  ReplayBuffer replay(problem_, 30, 2, kGamma);  // there is room for two collections of twelve
  for (int number = 1; number <= 5; ++number) Fill(&replay, number);
  EXPECT_EQ(replay.size(), 24);
  std::set<float> seen;
  Random random(1, Stream::kReplay, 0, 0, 0);
  for (int k = 0; k < 1000; ++k) seen.insert(*replay.At(replay.Draw(&random)).state);
  std::set<float> expected;
  for (int t = 0; t < kSteps; ++t) {
    for (int e = 0; e < 3; ++e) {
      expected.insert(Tag(4, t, e));
      expected.insert(Tag(5, t, e));
    }
  }
  EXPECT_EQ(seen, expected);
}

TEST_F(ReplayTest, TakesOneDivisionOfTheEnvironmentsOnly) {
  ReplayBuffer replay(problem_, 2 * 3 * kSteps, 2, kGamma);
  Fill(&replay, 0);
  Collection other;
  other.steps = kSteps;
  other.shards = {{0, 1}, {1, 2}};  // the same number of steps with other shards
  EXPECT_THROW(replay.Begin(other), UserError);
}

TEST_F(ReplayTest, IsSavedAndLoadedBitForBit) {
  for (const bool own : {false, true}) SaveAndLoad(own);
}

void ReplayTest::SaveAndLoad(bool own) {
  ReplayBuffer replay(problem_, 24, 3, kGamma, own), other(problem_, 24, 3, kGamma, own);
  for (int number = 1; number <= 3; ++number) Fill(&replay, number);
  Archive saved, again;
  replay.Save(&saved);
  other.Load(saved);
  other.Save(&again);
  EXPECT_TRUE(saved == again);
  Fill(&replay, 4);
  Fill(&other, 4);
  Archive one, two;
  replay.Save(&one);
  other.Save(&two);
  EXPECT_TRUE(one == two);
  Problem larger = problem_;
  larger.state_size = 2;
  ReplayBuffer misfit(larger, 24, 3, kGamma, own);
  EXPECT_THROW(misfit.Load(saved), UserError);
}

TEST_F(ReplayTest, ShiftedAndScaledRewardsMoveEveryValueAlike) {
  // A constant reward c has the value c / (1 - gamma) for any n. In the networks' units this is
  // zero.
  ReplayBatch batch(problem_, 1);
  ReplayScales scales;
  for (Normaliser* n : {&scales.observations, &scales.states}) {
    n->mean = {0.0F};
    n->std = {1.0F};
  }
  scales.reward_mean = 3.0F;
  scales.reward_std = 0.2F;
  const float zeros[2] = {};
  for (int steps = 1; steps <= 5; ++steps) {
    ReplayBuffer::Sample sample;
    sample.observations = sample.next_observations = sample.actions = zeros;
    sample.state = sample.next_state = zeros;
    float power = 1.0F;
    for (int k = 0; k < steps; ++k, power *= 0.5F) {
      sample.reward += 3.0F * power;
      sample.weight += power;
    }
    sample.discount = power;
    batch.Set(0, sample, scales);
    EXPECT_NEAR(batch.rewards[0], 0.0F, 1e-5F);
    EXPECT_EQ(batch.discounts[0], power);
  }
}

}  // namespace
}  // namespace stg::learn

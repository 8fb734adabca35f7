#include "marl_trainer/learn/collect/collector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>

#include "auv_common/config/files.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::learn {
namespace {

constexpr int kHorizon = 30;  // decisions per collection; an episode has 40

/// Everything that one shard saw.
struct Seen {
  std::vector<int> steps;
  std::vector<float> observations, states, actions, log_prob, teacher, rewards, team_rewards;
  std::vector<float> next_observations, next_states, final_states;
  std::vector<std::uint8_t> truncated;
};

/// Acts at random, by the keys alone, and records what it sees.
class Recorder : public Algorithm {
 public:
  explicit Recorder(const Problem& problem) : problem_(problem) {}

  void Begin(const Collection& collection) override {
    collection_ = collection;
    shards.assign(collection.shards.size(), Seen());
  }

  void Act(const Decision& d, const Actions& out) override {
    ASSERT_NE(d.explore, nullptr);
    for (int r = 0; r < d.envs * problem_.agents; ++r) {
      Random random(d.explore->seed, Stream::kPolicy, d.explore->collection, d.explore->step,
                    static_cast<std::uint32_t>(d.explore->first_env * problem_.agents + r));
      for (int a = 0; a < problem_.action_size; ++a) {
        out.actions[r * problem_.action_size + a] = static_cast<float>(random.Uniform(-0.5, 0.5));
      }
      out.log_prob[r] = static_cast<float>(r);
    }
  }

  void Observe(const Transition& t) override {
    Seen& s = shards[static_cast<std::size_t>(t.shard)];
    const int rows = t.envs * problem_.agents;
    const auto add = [](const float* from, int count, std::vector<float>* to) {
      if (from != nullptr) to->insert(to->end(), from, from + count);
    };
    s.steps.push_back(t.step);
    add(t.observations, rows * problem_.observation_size, &s.observations);
    add(t.states, t.envs * problem_.state_size, &s.states);
    add(t.actions, rows * problem_.action_size, &s.actions);
    add(t.log_prob, rows, &s.log_prob);
    add(t.teacher, rows * problem_.action_size, &s.teacher);
    add(t.rewards, rows, &s.rewards);
    add(t.team_rewards, t.envs, &s.team_rewards);
    add(t.next_observations, rows * problem_.observation_size, &s.next_observations);
    add(t.next_states, t.envs * problem_.state_size, &s.next_states);
    for (int e = 0; e < t.envs; ++e) {
      s.truncated.push_back(t.truncated[e]);
      if (t.truncated[e] == 0) continue;
      add(t.final_states + static_cast<std::ptrdiff_t>(e) * problem_.state_size,
          problem_.state_size, &s.final_states);
    }
  }

  UpdateReport Update(const UpdateContext&) override { return {}; }
  void Save(Archive*) const override {}
  void Load(const Archive&) override {}
  std::vector<agent::Policy> Policies(const agent::PolicyMetadata&) const override { return {}; }
  std::vector<ReportColumn> Columns() const override { return {}; }
  std::vector<NetworkSize> Sizes() const override { return {}; }

  const Collection& collection() const { return collection_; }
  std::vector<Seen> shards;

 private:
  const Problem problem_;
  Collection collection_;
};

class CollectorTest : public ::testing::Test {
 protected:
  CollectorTest()
      : scenario_(LoadNamedScenario(config::ScenarioFolder(), "medium_release", "nominal",
                                    {"time.episode_steps=40", "time.tail_steps=10"})),
        problem_(ProblemOf(scenario_.run, scenario_.world, scenario_.agent)) {
    config_.envs = 22;  // blocks of four, and one part of a block
    config_.horizon = kHorizon;
    config_.stagger = false;
  }

  /// What all shards saw in the second of two collections.
  std::vector<Seen> SecondCollection(int workers, bool teach) {
    WorkerPool pool(workers);
    Collector collector(env::EnvFactory(scenario_), config_, &imitation_, &pool);
    Recorder recorder(problem_);
    collector.Collect(0, teach, &recorder);
    report_ = collector.Collect(1, teach, &recorder);
    collection_ = recorder.collection();
    return recorder.shards;
  }

  const Scenario scenario_;
  const Problem problem_;
  TrainConfig config_;
  ImitationConfig imitation_;
  CollectionReport report_;
  Collection collection_;
};

/// The collector sets the stage of the curriculum, so any algorithm learns along it.
TEST_F(CollectorTest, EpisodesStartInTheStageOfTheCurriculum) {
  using dynamics::ResetStage;
  const auto observations = [&](bool curriculum, ResetStage stage, int easy_until,
                                int medium_until) {
    Scenario scenario = scenario_;
    scenario.world.reset.curriculum = curriculum;
    scenario.world.reset.stage = stage;
    scenario.world.reset.curriculum_easy_resets = easy_until;
    scenario.world.reset.curriculum_medium_resets = medium_until;
    WorkerPool pool(1);
    Collector collector(env::EnvFactory(scenario), config_, &imitation_, &pool);
    Recorder recorder(problem_);
    std::vector<std::vector<float>> seen;
    for (std::uint32_t number = 0; number < 2; ++number) {
      collector.Collect(number, false, &recorder);
      for (const Seen& shard : recorder.shards) seen.push_back(shard.observations);
    }
    return seen;
  };
  // 22 environments are reset twice. Each of them shows its first episode and a part of its second
  // one.
  const auto easy = observations(false, ResetStage::kEasy, 0, 0);
  const auto medium = observations(false, ResetStage::kMedium, 0, 0);
  const auto hard = observations(false, ResetStage::kHard, 0, 0);
  EXPECT_NE(easy, hard);
  EXPECT_EQ(observations(true, ResetStage::kHard, 44, 44), easy);
  EXPECT_EQ(observations(true, ResetStage::kHard, 0, 44), medium);
  EXPECT_EQ(observations(true, ResetStage::kEasy, 0, 0), hard);
  // First episodes are easy and second ones medium. They differ only after the reset.
  const auto both = observations(true, ResetStage::kHard, 22, 44);
  const std::size_t shards = both.size() / 2;
  for (std::size_t s = 0; s < shards; ++s) {
    EXPECT_EQ(both[s], easy[s]);
    const std::vector<float>& second = both[shards + s];
    EXPECT_NE(second, easy[shards + s]);
    const auto size = static_cast<std::ptrdiff_t>(second.size()) / kHorizon;
    EXPECT_TRUE(std::equal(second.end() - size, second.end(), medium[shards + s].end() - size));
  }
}

TEST_F(CollectorTest, ShowsEveryStepOfEveryEnvironmentOnceAndInOrder) {
  const std::vector<Seen> shards = SecondCollection(2, false);
  ASSERT_EQ(collection_.shards.size(), 6U);
  EXPECT_EQ(collection_.number, 1U);
  EXPECT_EQ(collection_.steps, kHorizon);
  EXPECT_EQ(collection_.shards[5].first_env, 20);
  EXPECT_EQ(collection_.shards[5].envs, 2);
  double reward = 0.0;
  for (std::size_t k = 0; k < shards.size(); ++k) {
    const Seen& s = shards[k];
    const auto envs = static_cast<std::size_t>(collection_.shards[k].envs);
    const auto agents = static_cast<std::size_t>(problem_.agents);
    const std::size_t state = envs * static_cast<std::size_t>(problem_.state_size);
    const std::size_t observation =
        envs * agents * static_cast<std::size_t>(problem_.observation_size);
    ASSERT_EQ(s.steps.size(), static_cast<std::size_t>(kHorizon));
    ASSERT_EQ(s.observations.size(), kHorizon * observation);
    EXPECT_TRUE(s.teacher.empty());
    for (std::size_t t = 0; t < kHorizon; ++t) {
      EXPECT_EQ(s.steps[t], static_cast<int>(t));
      for (std::size_t e = 0; e < envs; ++e) {
        // The first collection made 30 of the 40 steps of an episode.
        EXPECT_EQ(s.truncated[t * envs + e], t == 9 ? 1 : 0);
        double sum = 0.0;
        for (std::size_t i = 0; i < agents; ++i) {
          sum += static_cast<double>(s.rewards[(t * envs + e) * agents + i]);
        }
        EXPECT_NEAR(s.team_rewards[t * envs + e], sum / problem_.agents, 1e-6);
        reward += static_cast<double>(s.team_rewards[t * envs + e]) / (22.0 * kHorizon);
      }
      if (t + 1 == kHorizon) break;
      // The next state is the one of the next decision, also across the end of an episode.
      EXPECT_TRUE(std::equal(s.next_states.begin() + static_cast<std::ptrdiff_t>(t * state),
                             s.next_states.begin() + static_cast<std::ptrdiff_t>((t + 1) * state),
                             s.states.begin() + static_cast<std::ptrdiff_t>((t + 1) * state)));
      EXPECT_TRUE(std::equal(
          s.next_observations.begin() + static_cast<std::ptrdiff_t>(t * observation),
          s.next_observations.begin() + static_cast<std::ptrdiff_t>((t + 1) * observation),
          s.observations.begin() + static_cast<std::ptrdiff_t>((t + 1) * observation)));
    }
    // The state before the restart differs from the state after it.
    ASSERT_EQ(s.final_states.size(), state);
    EXPECT_FALSE(std::equal(s.final_states.begin(), s.final_states.end(),
                            s.next_states.begin() + static_cast<std::ptrdiff_t>(9 * state)));
    EXPECT_EQ(s.log_prob.back(), static_cast<float>(envs * agents - 1));
  }
  EXPECT_EQ(report_.finished.size(), 22U);
  EXPECT_NEAR(report_.reward, reward, 1e-9);
}

TEST_F(CollectorTest, DoesNotDependOnTheNumberOfWorkers) {
  const std::vector<Seen> one = SecondCollection(1, false), three = SecondCollection(3, false);
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k].observations, three[k].observations);
    EXPECT_EQ(one[k].actions, three[k].actions);
    EXPECT_EQ(one[k].rewards, three[k].rewards);
  }
}

TEST_F(CollectorTest, AsksTheTeacherAtTheStatesThatAreVisited) {
  imitation_.controller = "idle";
  imitation_.steps = 1;
  for (const Seen& s : SecondCollection(1, true)) {
    ASSERT_EQ(s.teacher.size(), s.actions.size());
    for (const float a : s.teacher) EXPECT_EQ(a, 0.0F);
  }
  const std::vector<Seen> idle = SecondCollection(1, true);
  imitation_.controller = "pursuit";
  const std::vector<Seen> pursuit = SecondCollection(1, true);
  // With or without a teacher, the swarm does what the algorithm decides.
  EXPECT_EQ(idle[0].states, pursuit[0].states);
  EXPECT_NE(idle[0].teacher, pursuit[0].teacher);
}

TEST_F(CollectorTest, RestartsWhereItIsTold) {
  WorkerPool pool(1);
  config_.stagger = true;
  Collector collector(env::EnvFactory(scenario_), config_, &imitation_, &pool);
  Recorder recorder(problem_);
  EXPECT_TRUE(collector.at_episode_start());
  collector.Collect(0, false, &recorder);
  EXPECT_FALSE(collector.at_episode_start());
  collector.RestartAt(5);
  EXPECT_TRUE(collector.at_episode_start());
  EXPECT_EQ(collector.round(), 5U);
  collector.Collect(1, false, &recorder);
  const std::vector<Seen> first = recorder.shards;
  Collector fresh(env::EnvFactory(scenario_), config_, &imitation_, &pool);
  fresh.RestartAt(5);
  fresh.Collect(1, false, &recorder);
  for (std::size_t k = 0; k < first.size(); ++k)
    EXPECT_EQ(first[k].states, recorder.shards[k].states);
  // The ends are staggered, so not all environments end in the same step.
  std::set<std::vector<std::uint8_t>> ends;
  // Each shard has four environments.
  for (std::size_t k = 0; k < 5; ++k) ends.insert(first[k].truncated);
  EXPECT_GT(ends.size(), 1U);
}

}  // namespace
}  // namespace stg::learn

#include "marl_trainer/learn/recorded/recorded.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <sstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "learn/mappo_setup.hpp"
#include "marl_trainer/learn/recorded/recorded_trainer.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::learn {
namespace {

namespace fs = std::filesystem;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int kSteps = 20;
constexpr TimeNs kSecond = 1000000000;

class RecordedTest : public ::testing::Test {
 protected:
  void SetUp() override {
    trainer_ = std::make_unique<RecordedTrainer>(scenario_, MakeSetup(), Options("run"));
  }

  static TrainSetup MakeSetup() {
    TrainSetup setup = RecordedSetup(Short().run);
    MappoConfig& own = Own(setup);
    own.actor_hidden = {8};
    own.critic_hidden = {8};
    own.lr = own.critic_lr = 1e-2;
    own.gamma = 0.0;  // each action gets its reward at once
    return setup;
  }
  static Scenario Short() {
    return LoadNamedScenario(config::ScenarioFolder(), "medium", "nominal",
                             {"time.episode_steps=20", "time.tail_steps=10"});
  }
  RecordedTrainer::Options Options(const std::string& name, const std::string& policy = "") {
    RecordedTrainer::Options options;
    options.out = (folder_ / name).string();
    options.policy = policy;
    options.log = &log_;
    return options;
  }

  /// A record with actions from the policy. The reward is largest if the first component is 0.5.
  AgentRecord Step(const agent::Policy& policy, std::uint32_t episode, std::uint32_t t,
                   int agent) const {
    Random random(7, Stream::kPolicy, episode, t, static_cast<std::uint32_t>(agent));
    AgentRecord r;
    r.layout_version = 1;
    for (int i = 0; i < policy.observation_size(); ++i) {
      r.observation.push_back(static_cast<float>(random.Normal()));
    }
    r.observation[0] = 0.25F;  // this number is always the same
    r.action.resize(static_cast<std::size_t>(policy.action_size()));
    policy.Mean(r.observation.data(), r.action.data());
    double density = 1.0;
    for (std::size_t a = 0; a < r.action.size(); ++a) {
      const double sigma =
          std::exp(double{policy.parameters().log_std[static_cast<Eigen::Index>(a)]});
      const double z = random.Normal();
      r.action[a] += static_cast<float>(sigma * z);
      density *= std::exp(-z * z / 2.0) / (sigma * std::sqrt(2.0 * M_PI));
    }
    r.log_probability = static_cast<float>(std::log(density));
    r.policy_id = policy.metadata().id;
    return r;
  }

  RecordedEpisode Episode(std::uint32_t number) const {
    EpisodeAssembler assembler(scenario_.run, "test");
    Record(number, TimeNs{number} * 100 * kSecond, &assembler);
    std::vector<RecordedEpisode> all = assembler.TakeAll();
    EXPECT_EQ(all.size(), 1U);
    return all.front();
  }

  void Record(std::uint32_t number, TimeNs start, EpisodeAssembler* assembler,
              std::uint32_t steps = kSteps) const {
    for (std::uint32_t t = 0; t < steps; ++t) {
      RewardRecord reward;
      for (int i = 0; i < scenario_.run.agents; ++i) {
        AgentRecord r = Step(trainer_->policy(), number, t, i);
        const double off = double{r.action[0]} - 0.5;
        reward.reward += (1.0 - off * off) / scenario_.run.agents;
        assembler->Add(number, start, t, i, std::move(r));
      }
      const auto size = static_cast<std::size_t>(trainer_->state_size());
      reward.state.assign(size, 0.01F * static_cast<float>(t));
      reward.truncated = t == kSteps - 1;
      if (reward.truncated) reward.final_state.assign(size, 0.5F);
      assembler->Add(number, start, t, std::move(reward));
    }
  }

  static Archive State(const RecordedTrainer& trainer) {
    Archive archive;
    trainer.algorithm().Save(&archive);
    return archive;
  }

  const Scenario scenario_ = Short();
  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::ostringstream log_;
  std::unique_ptr<RecordedTrainer> trainer_;
};

TEST_F(RecordedTest, AcceptsAnEpisodeThatThePolicyFlew) {
  const Finding finding = trainer_->Check(Episode(0));
  EXPECT_EQ(finding.flaw, Flaw::kNone) << finding.where;
}

TEST_F(RecordedTest, NamesEachFlawOfAnEpisode) {
  const struct {
    Flaw flaw;
    std::function<void(RecordedEpisode*)> spoil;
  } cases[] = {
      {Flaw::kGap, [](auto* e) { e->steps[2].erase(7); }},
      {Flaw::kGap, [](auto* e) { e->steps[1].clear(); }},
      {Flaw::kNoReward, [](auto* e) { e->rewards.erase(3); }},
      {Flaw::kUnfinished, [](auto* e) { e->rewards.erase(kSteps - 1); }},
      {Flaw::kUnfinished, [](auto* e) { e->rewards[kSteps - 1].truncated = false; }},
      {Flaw::kContradiction,
       [](auto* e) {
         e->rewards[4].truncated = true, e->rewards[4].final_state = e->rewards[4].state;
       }},
      {Flaw::kObservation, [](auto* e) { e->steps[0][5].layout_version = 2; }},
      {Flaw::kObservation, [](auto* e) { e->steps[3][0].observation.pop_back(); }},
      {Flaw::kAction, [](auto* e) { e->steps[0][5].action.push_back(0.0F); }},
      {Flaw::kAction, [](auto* e) { e->steps[0][5].action.clear(); }},
      {Flaw::kState, [](auto* e) { e->rewards[0].state.push_back(0.0F); }},
      {Flaw::kState, [](auto* e) { e->rewards[kSteps - 1].final_state.clear(); }},
      {Flaw::kNotFinite, [](auto* e) { e->steps[0][5].observation[73] = kNan; }},
      {Flaw::kNotFinite, [](auto* e) { e->steps[0][5].action[1] = INFINITY; }},
      {Flaw::kNotFinite, [](auto* e) { e->steps[0][5].log_probability = kNan; }},
      {Flaw::kNotFinite, [](auto* e) { e->rewards[9].reward = 1e300; }},
      {Flaw::kNotFinite, [](auto* e) { e->rewards[9].state[0] = kNan; }},
      {Flaw::kNotFinite, [](auto* e) { e->rewards[kSteps - 1].final_state[0] = kNan; }},
      {Flaw::kForeignPolicy, [](auto* e) { e->steps[2][19].policy_id = "pursuit"; }},
      {Flaw::kForeignPolicy, [](auto* e) { e->steps[2][0].policy_id.clear(); }},
      {Flaw::kLogProbability, [](auto* e) { e->steps[2][19].log_probability += 0.01F; }},
      {Flaw::kLogProbability, [](auto* e) { e->steps[2][19].action[0] += 1.0F; }},
  };
  const RecordedEpisode good = Episode(0);
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    RecordedEpisode spoilt = good;
    cases[i].spoil(&spoilt);
    EXPECT_EQ(trainer_->Check(spoilt).flaw, cases[i].flaw) << "case " << i;
  }
}

TEST_F(RecordedTest, KeepsRunsApartThatCountEpisodesFromZero) {
  EpisodeAssembler assembler(scenario_.run, "test");
  Record(0, 0, &assembler);
  Record(0, 500 * kSecond, &assembler, kSteps / 2);
  const std::vector<RecordedEpisode> all = assembler.TakeAll();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(trainer_->Check(all[0]).flaw, Flaw::kNone);
  EXPECT_EQ(trainer_->Check(all[1]).flaw, Flaw::kUnfinished);
}

TEST_F(RecordedTest, ARepeatedMessageIsFineAndAContradictoryOneIsNot) {
  EpisodeAssembler assembler(scenario_.run, "test");
  Record(0, 0, &assembler);
  Record(0, 0, &assembler);
  assembler.Add(0, 0, kSteps, 0, AgentRecord());  // the decision after the end has no effect
  EXPECT_EQ(trainer_->Check(assembler.TakeAll().front()).flaw, Flaw::kNone);
  Record(0, 0, &assembler);
  AgentRecord other = Step(trainer_->policy(), 0, 3, 1);
  other.action[0] += 0.1F;
  assembler.Add(0, 0, 3, 1, other);
  EXPECT_EQ(trainer_->Check(assembler.TakeAll().front()).flaw, Flaw::kContradiction);
  Record(0, 0, &assembler);
  assembler.Add(0, 0, kSteps, RewardRecord());
  EXPECT_EQ(trainer_->Check(assembler.TakeAll().front()).flaw, Flaw::kContradiction);
}

TEST_F(RecordedTest, GivesUpEpisodesThatNewerOnesOvertook) {
  EpisodeAssembler assembler(scenario_.run, "live");
  Record(0, 0, &assembler, 5);
  Record(1, 100 * kSecond, &assembler);
  std::vector<RecordedEpisode> done = assembler.TakeDone();
  ASSERT_EQ(done.size(), 1U);
  EXPECT_EQ(done[0].number, 1U);
  Record(2, 200 * kSecond, &assembler, 5);
  EXPECT_TRUE(assembler.TakeDone().empty());
  Record(3, 300 * kSecond, &assembler, 5);
  done = assembler.TakeDone();
  ASSERT_EQ(done.size(), 1U);
  EXPECT_EQ(done[0].number, 0U);
}

TEST_F(RecordedTest, StepsFromTheFutureTakeNoEpisodesPlace) {
  EpisodeAssembler assembler(scenario_.run, "live");
  for (const std::uint32_t number : {900U, 901U}) {
    assembler.Add(number, number * 100 * kSecond, 3, 0, Step(trainer_->policy(), number, 3, 0));
  }
  for (std::uint32_t number = 0; number < 5; ++number) {
    Record(number, number * 100 * kSecond, &assembler, kSteps / 2);
    // A live trainer also asks in the middle of each episode.
    for (const RecordedEpisode& e : assembler.TakeDone()) EXPECT_GE(e.number, 900U);
    Record(number, number * 100 * kSecond, &assembler);
    const std::vector<RecordedEpisode> done = assembler.TakeDone();
    ASSERT_EQ(done.size(), 1U) << number;
    EXPECT_EQ(done[0].number, number);
    EXPECT_EQ(trainer_->Check(done[0]).flaw, Flaw::kNone);
  }
}

TEST_F(RecordedTest, LateWordsOpenNoEpisodeAnew) {
  EpisodeAssembler assembler(scenario_.run, "live");
  for (std::uint32_t number = 0; number < 4; ++number) {
    Record(number, number * 100 * kSecond, &assembler, kSteps / 2);
  }
  EXPECT_EQ(assembler.TakeDone().size(), 2U) << "two are kept open";
  for (std::uint32_t t = kSteps / 2; t < kSteps; ++t) {
    assembler.Add(0, 0, t, 0, Step(trainer_->policy(), 0, t, 0));
    EXPECT_TRUE(assembler.TakeDone().empty());
  }
  EXPECT_EQ(assembler.late(), std::uint64_t{kSteps / 2});
}

TEST_F(RecordedTest, LearnsWhichActionIsRewarded) {
  const auto mean_action = [this] {
    double sum = 0.0;
    for (std::uint32_t t = 0; t < 100; ++t) {
      const AgentRecord r = Step(trainer_->policy(), 999, t, 0);
      float action[6];
      trainer_->policy().Mean(r.observation.data(), action);
      sum += double{action[0]} / 100.0;
    }
    return sum;
  };
  EXPECT_LT(std::abs(mean_action()), 0.1);  // the policy is not trained yet
  std::uint32_t number = 0;
  for (int update = 0; update < 30; ++update) {
    std::vector<RecordedEpisode> episodes;
    for (int e = 0; e < 4; ++e) episodes.push_back(Episode(number++));
    for (const auto& e : episodes) ASSERT_EQ(trainer_->Check(e).flaw, Flaw::kNone);
    const RecordedTrainer::Progress p = trainer_->Update(episodes);
    EXPECT_EQ(p.env_steps, (update + 1) * 4 * kSteps);
  }
  EXPECT_NEAR(mean_action(), 0.5, 0.15);
}

TEST_F(RecordedTest, EachUpdateMakesAPolicyOfItsOwnAndRefusesTheLastOnesEpisodes) {
  const std::string first = trainer_->policy_id();
  EXPECT_EQ(agent::Policy::LoadOnnx(trainer_->policy_path()).metadata().id, first);
  const RecordedEpisode episode = Episode(0);
  trainer_->Update({episode});
  EXPECT_NE(trainer_->policy_id(), first);
  EXPECT_EQ(agent::Policy::LoadOnnx(trainer_->policy_path()).metadata().id, trainer_->policy_id());
  EXPECT_EQ(trainer_->Check(episode).flaw, Flaw::kForeignPolicy);
}

TEST_F(RecordedTest, GoesOnFromItsFolderAsIfItHadNeverStopped) {
  trainer_->Update({Episode(0)});
  const RecordedEpisode second = Episode(1);
  const std::string id = trainer_->policy_id();
  fs::copy(folder_ / "run", folder_ / "copy");
  trainer_->Update({second});
  RecordedTrainer resumed(scenario_, MakeSetup(), Options("copy"));
  EXPECT_EQ(resumed.policy_id(), id);
  EXPECT_EQ(resumed.Check(second).flaw, Flaw::kNone);
  resumed.Update({second});
  EXPECT_EQ(resumed.policy_id(), trainer_->policy_id());
  EXPECT_TRUE(State(resumed) == State(*trainer_));
}

TEST_F(RecordedTest, StartsFromAPolicyAndKeepsItsFunction) {
  TrainSetup scaled = MakeSetup();
  Own(scaled).std_scale = 0.3;  // the policy file does not hold this option, only its effect
  trainer_ = std::make_unique<RecordedTrainer>(scenario_, scaled, Options("scaled"));
  trainer_->Update({Episode(0), Episode(1)});
  const RecordedEpisode episode = Episode(2);
  TrainSetup setup = MakeSetup();
  Own(setup).actor_hidden = {32, 32};  // the shape of the policy counts
  {
    RecordedTrainer other(scenario_, setup, Options("other", trainer_->policy_path()));
    EXPECT_EQ(other.policy_id(), trainer_->policy_id());
    ASSERT_EQ(other.Check(episode).flaw, Flaw::kNone);
    other.Update({episode});
  }
  EXPECT_THROW(RecordedTrainer(scenario_, MakeSetup(), Options("other", trainer_->policy_path())),
               UserError)
      << "the folder holds another policy's training by now";
}

TEST_F(RecordedTest, RefusesAFolderThatAnotherTrainerWritesInto) {
  EXPECT_THROW(RecordedTrainer(scenario_, MakeSetup(), Options("run")), UserError);
  trainer_.reset();
  EXPECT_NO_THROW(RecordedTrainer(scenario_, MakeSetup(), Options("run")));
}

TEST_F(RecordedTest, RefusesAFolderOfAnotherScenarioAndABadMinibatch) {
  trainer_->Update({Episode(0)});
  Scenario other = scenario_;
  other.reward.weights.tracking *= 2.0;
  trainer_.reset();
  EXPECT_THROW(RecordedTrainer(other, MakeSetup(), Options("run")), UserError);
  TrainSetup setup = MakeSetup();
  Own(setup).minibatch = 7;
  EXPECT_THROW(RecordedTrainer(scenario_, setup, Options("new")), UserError);
}

TEST(RecordingReport, CountsByReason) {
  RecordingReport report;
  report.used = 1;
  report.dropped[static_cast<std::size_t>(Flaw::kGap)] = 2;
  report.dropped[static_cast<std::size_t>(Flaw::kNotFinite)] = 1;
  report.unreadable_sources = 1;
  EXPECT_EQ(report.Text(),
            "1 episode used, 3 dropped (2 steps missing, 1 NaN or infinity), 1 bags unreadable");
}

}  // namespace
}  // namespace stg::learn

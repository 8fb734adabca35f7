#include "stg_env/task/reward_term.hpp"

#include <gtest/gtest.h>

#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "stg_env/task/task.hpp"

namespace stg::task {
namespace {

/// Gives the index of the AUV, so that a test sees which AUV was asked, in both number types.
struct Index : TermOf<Index> {
  template <class T>
  T Of(const TermInput<T>& in) const {
    return T(static_cast<double>(in.agent));
  }
};

/// The change of the executed action since the last decision.
struct Change : TermOf<Change> {
  template <class T>
  T Of(const TermInput<T>& in) const {
    const auto i = static_cast<std::size_t>(in.agent);
    return in.swarm.action[i][0] - in.previous_action[0];
  }
};

void RegisterOnce() {
  if (RewardTermsByName().Has("test_index")) return;
  RewardTermsByName().Add("test_index",
                          [](const JudgeConfig&) { return std::make_unique<Index>(); });
}

Scenario With(const std::vector<std::string>& overrides) {
  return env::Short(env::Shipped("medium", "nominal", overrides), 20);
}

/// The total reward of each AUV after three random decisions, [env, agent].
std::vector<double> Totals(const Scenario& s) {
  const env::VectorEnvOptions o;
  env::TestEnv env(s, o);
  env.Reset();
  for (int k = 0; k < 3; ++k) env.Step(env::ActionsOf(env, o));
  std::vector<double> totals;
  for (int e = 0; e < env.envs(); ++e) {
    for (int i = 0; i < s.run.agents; ++i) totals.push_back(env.terms(e, i).total);
  }
  return totals;
}

TEST(RewardTerms, AWeightOfZeroChangesNoBit) {
  RegisterOnce();
  EXPECT_EQ(Totals(With({})), Totals(With({"reward.terms.effort.weight=0"})));
  EXPECT_EQ(Totals(With({"mode=truth"})),
            Totals(With({"mode=truth", "reward.terms.test_index.weight=0"})));
}

TEST(RewardTerms, AreAddedToEveryAuvsTotalTimesTheirWeight) {
  RegisterOnce();
  const auto plain = Totals(With({})),
             more = Totals(With({"reward.terms.test_index.weight=0.125"}));
  for (std::size_t k = 0; k < plain.size(); ++k) {
    EXPECT_NEAR(more[k], plain[k] + 0.125 * static_cast<double>(k % 4), 1e-12);
  }
  const auto both =
      Totals(With({"reward.terms.test_index.weight=0.125", "reward.terms.effort.weight=0.5"}));
  EXPECT_NE(both[0], more[0]);
}

TEST(RewardTerms, TheTotalIsClippedAfterThem) {
  RegisterOnce();
  for (const double total : Totals(With({"reward.terms.test_index.weight=900"}))) {
    EXPECT_LE(total, 2.0);
  }
}

TEST(RewardTerms, EffortIsTheMeanSquareOfTheForces) {
  const Scenario s = With({"control.interface=tau6", "reward.terms.effort.weight=1", "agents=1"});
  const Scenario without = With({"control.interface=tau6", "agents=1"});
  double total[2];
  for (int k = 0; k < 2; ++k) {
    env::TestEnv env(k == 0 ? s : without);
    env.Reset();
    std::vector<float> actions = env::Idle(env);
    actions[0] = 0.5F;  // surge and yaw of environment 0
    actions[5] = -1.0F;
    env.Step(actions);
    total[k] = env.terms(0, 0).total;
  }
  EXPECT_NEAR(total[0] - total[1], -(0.25 + 1.0) / 6.0, 1e-12);
}

TEST(RewardTerms, OfTwoNumberTypesGiveTheSame) {
  const Change term;
  dynamics::Separations<double> one;
  dynamics::Separations<Pack> many;
  const std::vector<dynamics::VehicleState<double>> v(1);
  const std::vector<dynamics::VehicleState<Pack>> w(1);
  const Efforts<double> action{{0.5, 0, 0, 0, 0, 0}}, none{{0, 0, 0, 0, 0, 0}};
  Efforts<Pack> actions(1), nones(1);
  for (int k = 0; k < 6; ++k) {
    actions[0][static_cast<std::size_t>(k)] = Pack(k == 0 ? 0.5 : 0.0);
    nones[0][static_cast<std::size_t>(k)] = Pack(0.0);
  }
  const SwarmState<double> a{v, {}, one, none, action, 0.0};
  const SwarmState<Pack> b{w, {}, many, nones, actions, Pack(0.0)};
  const double expected = term.Evaluate({a, 0, {}, none[0], none[0]});
  EXPECT_EQ(expected, 0.5);
  const Pack packed = term.Evaluate({b, 0, {}, nones[0], nones[0]});
  for (int lane = 0; lane < kLanes; ++lane) EXPECT_EQ(Lane(packed, lane), expected);
}

TEST(RewardTerms, AnUnknownNameIsRefusedWithTheKey) {
  try {
    With({"reward.terms.efort.weight=0.1"});
    ADD_FAILURE() << "no UserError";
  } catch (const UserError& e) {
    const std::string message = e.what();
    EXPECT_NE(message.find("reward.terms.efort.weight: unknown key"), std::string::npos) << message;
    EXPECT_NE(message.find("reward.terms.effort"), std::string::npos) << message;
  }
  EXPECT_THROW(With({"reward.terms.effort.weight=1e9"}), UserError);
  Scenario s = With({});
  s.reward.terms["no_such_term"] = 1.0;
  EXPECT_THROW(Task<double> task(s.judge()), UserError);
}

TEST(RewardTerms, StandInASavedScenarioOnlyWhenTheyCount) {
  const std::string plain = ToYaml(With({})),
                    with = ToYaml(With({"reward.terms.effort.weight=0.25"}));
  EXPECT_EQ(plain.find("terms:"), std::string::npos);
  EXPECT_NE(with.find("  terms:\n    effort:\n      weight: 0.25\n"), std::string::npos) << with;
  EXPECT_NE(ScenarioHash(With({})), ScenarioHash(With({"reward.terms.effort.weight=0.25"})));
}

}  // namespace
}  // namespace stg::task

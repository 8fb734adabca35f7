#include "learn/trainer_fixture.hpp"
#include "marl_trainer/learn/run/validation.hpp"
#include "stg_env/env/variants.hpp"

namespace stg::learn {
namespace {

TEST_F(TrainerTest, TheBestPolicyIsChosenByTheTrainingsOwnReward) {
  TrainSetup setup = SmallSetup();
  setup.common.variant = env::Variant::kTau6;
  setup.common.validation_interval = 640;
  const Scenario scenario = ShortScenario();
  Trainer trainer(scenario, setup, Options("run"));
  ASSERT_TRUE(trainer.Run());
  std::ifstream csv(folder_ / "run" / "progress.csv");
  std::string line;
  const auto cells = [&] {
    std::vector<std::string> found;
    std::getline(csv, line);
    std::stringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) found.push_back(cell);
    return found;
  };
  const std::vector<std::string> header = cells();
  const auto column = [&](const std::string& name) {
    return static_cast<size_t>(std::find(header.begin(), header.end(), name) - header.begin());
  };
  const size_t own = column("validation_return"), judged = column("validation_scenario_return");
  ASSERT_LT(judged, header.size());
  double best = -1e300, last = 0.0, last_judged = 0.0;
  for (auto row = cells(); !row.empty(); row = cells()) {
    if (row.size() <= judged || row[own].empty()) continue;
    last = std::stod(row[own]);
    last_judged = std::stod(row[judged]);
    best = std::max(best, last);
  }
  EXPECT_NEAR(trainer.state().best_return, best, 1e-6 * std::abs(best));
  // The two returns belong to the last policy, by two rewards. The test flies it again here.
  WorkerPool pool(1);
  const auto fly = [&](const Scenario& s) {
    return task::Summarise(Validate(env::EnvFactory(s), 4, &trainer.algorithm(), &pool));
  };
  const auto by_own = fly(env::VariantScenario(scenario, env::Variant::kTau6));
  const auto by_scenario = fly(env::EvaluationScenario(scenario, env::Variant::kTau6));
  EXPECT_NEAR(last, by_own.Mean("return"), 1e-6 * std::abs(last));
  EXPECT_NEAR(last_judged, by_scenario.Mean("return"), 1e-6 * std::abs(last_judged));
  EXPECT_GT(std::abs(last - last_judged), 0.1);
  EXPECT_EQ(by_own.Mean("tail_distance"), by_scenario.Mean("tail_distance"));
}

}  // namespace
}  // namespace stg::learn

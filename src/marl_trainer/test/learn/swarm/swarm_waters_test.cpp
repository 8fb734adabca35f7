#include <gtest/gtest.h>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "marl_trainer/learn/swarm/swarm_config.hpp"
#include "stg_agent/entities/entity_pilot.hpp"

/// The waters of a training that --waters names.
namespace stg::learn {
namespace {

TEST(SwarmWaters, OwnWatersTakeThePlacesOfTheMixture) {
  SwarmConfig config;
  config.leaving = false;
  config.waters = "utracking:legs_hard,hunt::6,field:sparse:3:2";
  const std::string folder = config::ScenarioFolder();
  const std::vector<SwarmTask> tasks = FieldMixture(
      folder, "field", config, 4, {"reward.terms.estimate.weight=0.7", "sensing.period_s=60"});
  ASSERT_EQ(tasks.size(), 4u);
  EXPECT_EQ(tasks[0].name, "utracking/legs_hard/5");
  EXPECT_EQ(tasks[1].name, "hunt/nominal/6");
  EXPECT_EQ(tasks[2].name, "field/sparse/3");
  EXPECT_EQ(tasks[3].name, tasks[0].name) << "in turn";
  EXPECT_EQ(tasks[0].scenario.world.target.count, 5);
  EXPECT_EQ(tasks[1].scenario.run.agents, 6);
  EXPECT_EQ(tasks[2].scenario.world.target.count, 2);
  for (const SwarmTask& task : tasks) {
    EXPECT_EQ(task.scenario.world.sensing.period_s, 60.0);
    EXPECT_EQ(task.scenario.run.time.episode_steps, config.episode_steps);
  }
  const std::vector<SwarmTask> validation = FieldValidation(folder, "field", config);
  ASSERT_EQ(validation.size(), 3u);
  EXPECT_EQ(validation[0].name, "utracking:legs_hard");
  EXPECT_EQ(validation[0].scenario.run.time.episode_steps, 256) << "unchanged";
}

TEST(SwarmWaters, WatersThatCannotBeAreRefused) {
  SwarmConfig config;
  const std::string folder = config::ScenarioFolder();
  for (const char* waters : {"field:sparse:0", "field:sparse:4:x", "field:sparse:4:1:1", ":sparse",
                             "field:no_such_condition", "field,,hunt"}) {
    config.waters = waters;
    EXPECT_THROW(FieldMixture(folder, "field", config, 4), UserError) << waters;
  }
  config.waters = "field,hunt";
  EXPECT_THROW(FieldMixture(folder, "field", config, 1), UserError) << "a place for each";
  config.network = agent::EntityNetwork::kGraph;
  config.free_assignment = true;
  EXPECT_THROW(FieldMixture(folder, "field", config, 16), UserError) << "nothing to replace";
}

TEST(SwarmWaters, ACommandLastsAtLeastADecision) {
  const auto run = [](const char* name) {
    return LoadNamedScenario(config::ScenarioFolder(), name, "nominal").run;
  };
  EXPECT_EQ(agent::DecisionsPerCommand(run("field")), 5);
  EXPECT_EQ(agent::CommandPeriod_s(run("field")), 5.0);
  EXPECT_EQ(agent::DecisionsPerCommand(run("utracking")), 1);
  EXPECT_EQ(agent::CommandPeriod_s(run("utracking")), 30.0);
}

}  // namespace
}  // namespace stg::learn

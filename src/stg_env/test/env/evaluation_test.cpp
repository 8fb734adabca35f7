#include "stg_env/env/evaluation.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "env/env_fixture.hpp"
#include "stg_env/env/seed_blocks.hpp"

namespace stg::env {
namespace {

/// Flies `episodes` episodes from `seed` on, on `workers` threads.
std::vector<task::EpisodeMetrics> Fly(const Scenario& s, const agent::Decider& c, int episodes,
                                      std::uint64_t seed, int workers = 1) {
  WorkerPool pool(workers);
  return Evaluate(EnvFactory(s), c, {episodes, seed, kMixBlock}, &pool);
}

double Value(const task::EpisodeMetrics& m, const std::string& name) {
  for (const auto& item : m.Items()) {
    if (item.first == name) return item.second;
  }
  ADD_FAILURE() << name;
  return 0.0;
}

TEST(Evaluate, DoesNotDependOnTheNumberOfWorkers) {
  for (const char* mode : {"mode=truth", "mode=acoustic"}) {
    Scenario s = Short(Shipped("medium", "nominal", {mode}), 60);
    s.world.sensing.noise_std_m = 0.002;
    const agent::Decider c = agent::MakeDecider("pursuit_separated", s.model());
    const auto one = Fly(s, c, 11, 3000);
    ASSERT_EQ(one.size(), 11u);
    for (const int workers : {2, 5}) {
      const auto many = Fly(s, c, 11, 3000, workers);
      ASSERT_EQ(many.size(), one.size());
      for (size_t e = 0; e < one.size(); ++e) {
        EXPECT_EQ(one[e].Items(), many[e].Items()) << mode << " " << workers << " " << e;
      }
    }
    EXPECT_NE(one[0].Items(), one[1].Items());
  }
}

TEST(Evaluate, EpisodeEIsTheEpisodeOfSeedPlusEHoweverManyAreRun) {
  const Scenario s = Short(Shipped("medium_release"), 40);
  const agent::Decider c = agent::MakeDecider("pursuit", s.model());
  const auto many = Fly(s, c, 9, 3000);
  EXPECT_EQ(many[7].Items(), Fly(s, c, 1, 3007)[0].Items());
  EXPECT_EQ(many[2].Items(), Fly(s, c, 3, 3000)[2].Items());
}

TEST(Evaluate, AMixFliesItsScenariosInTurn) {
  const std::vector<Scenario> mix = {Short(Shipped("medium_release"), 30),
                                     Short(Shipped("hard_release"), 30)};
  const agent::Decider c = agent::MakeDecider("pursuit", mix[0].model());
  WorkerPool pool(2);
  const auto mixed = Evaluate(EnvFactory(mix), c, {20, 3000, kMixBlock}, &pool);
  ASSERT_EQ(mixed.size(), 20u);
  for (std::size_t e = 0; e < mixed.size(); ++e) {
    const Scenario& s = mix[e / kMixBlock % mix.size()];
    EXPECT_EQ(mixed[e].Items(), Fly(s, c, 1, 3000 + e)[0].Items()) << e;
  }
}

TEST(Evaluate, ReportsProgressUpToTheNumberOfEpisodes) {
  const Scenario s = Short(Shipped("medium_release"), 5);
  int last = 0;
  Evaluate(EnvFactory(s), agent::MakeDecider("idle", s.model()), {6, 1, kMixBlock}, nullptr,
           [&](int done) {
             EXPECT_GT(done, last);
             last = done;
           });
  EXPECT_EQ(last, 6);
}

TEST(MakeDecider, AnUnknownNameOrMissingFileIsAUserError) {
  const Scenario s;
  EXPECT_THROW(agent::MakeDecider("pursiut", s.model()), UserError);
  EXPECT_THROW(agent::MakeDecider("/nonexistent/policy.onnx", s.model()), UserError);
}

/// A policy that always answers tanh(bias).
agent::Policy ConstantPolicy(const Scenario& s, float bias) {
  agent::Policy::Parameters p;
  p.input_mean = Eigen::VectorXf::Zero(s.agent.observation_size());
  p.input_std = Eigen::VectorXf::Ones(s.agent.observation_size());
  p.layers.push_back(
      {Eigen::MatrixXf::Zero(s.world.control.action_size(), s.agent.observation_size()),
       Eigen::VectorXf::Constant(s.world.control.action_size(), bias)});
  p.log_std = Eigen::VectorXf::Zero(s.world.control.action_size());
  p.metadata.observation_layout = agent::ObservationLayout(s.agent.observation);
  p.metadata.action_interface = agent::ActionInterfaceName(s.world.control.interface);
  return agent::Policy(std::move(p));
}

TEST(MakeDecider, EachAuvFliesItsOwnPolicyWhereThereAreAsMany) {
  const Scenario s = Shipped("medium_release");
  const TemporaryFolder temporary;
  const std::string folder = temporary.path().string();
  const auto file = [&](int i) { return folder + "/p_" + std::to_string(i) + ".onnx"; };
  for (int i = 0; i < s.run.agents; ++i) {
    ConstantPolicy(s, 0.1F * static_cast<float>(i)).SaveOnnx(file(i));
  }
  VectorEnvOptions options;
  options.envs = 3;
  VectorEnv env(s, options);
  EnvMemory memory = env.MakeMemory();
  env.RestartAt(0, memory.arrays());
  std::vector<double> actions(
      static_cast<std::size_t>(3 * s.run.agents * s.world.control.action_size()));
  const agent::Decider own = agent::MakeDecider(folder + "/p.onnx", s.model());
  EXPECT_EQ(own.policies.size(), static_cast<std::size_t>(s.run.agents));
  Decide(own, env, memory.observations.data(), actions.data());
  for (std::size_t i = 0; i < actions.size(); ++i) {
    const auto row = static_cast<int>(i) / s.world.control.action_size();
    EXPECT_NEAR(actions[i], std::tanh(0.1 * (row % s.run.agents)), 1e-6);
  }
  std::filesystem::remove(file(2));
  EXPECT_THROW(agent::MakeDecider(folder + "/p.onnx", s.model()), UserError);
  // A policy for all AUVs is preferred to one for each.
  ConstantPolicy(s, 1.0F).SaveOnnx(folder + "/p.onnx");
  EXPECT_EQ(agent::MakeDecider(folder + "/p.onnx", s.model()).policies.size(), 1U);
}

/// A row of the table in the reference (400 episodes of the release's simulator).
struct Reference {
  const char *scenario, *condition;
  double simple_return, simple_distance, tuned_return, tuned_distance, simple_pairs, tuned_pairs;
};
const Reference kTable[] = {
    {"medium_release", "nominal", 1000.4, .0142, 1027.0, .0123, 1.29, 4.80},
    {"medium_release", "fast_target", 957.8, .0149, 1026.8, .0123, 2.42, 4.78},
    {"medium_release", "far_initialization", 960.3, .0148, 1022.4, .0123, 2.21, 4.70},
    {"medium_release", "limited_sensing", 990.8, .0142, 1017.8, .0123, 1.29, 4.80},
    {"medium_release", "combined_stress", 943.9, .0150, 1013.0, .0124, 2.42, 4.70},
    {"hard_release", "nominal", 960.3, .0148, 1022.4, .0123, 2.21, 4.70},
    {"hard_release", "fast_target", 924.5, .0161, 1020.5, .0125, 3.13, 4.65},
    {"hard_release", "limited_sensing", 950.7, .0148, 1013.1, .0123, 2.21, 4.70},
    {"hard_release", "combined_stress", 914.9, .0161, 1011.2, .0125, 3.13, 4.65},
};

TEST(Pursuit, AgreesWithTheReleasesSimulatorInEveryCondition) {
  constexpr int kEpisodes = 60, kReferenceEpisodes = 400;
  for (const Reference& row : kTable) {
    const Scenario s = Shipped(row.scenario, row.condition);
    for (const bool tuned : {false, true}) {
      const agent::Decider c =
          agent::MakeDecider(tuned ? "pursuit" : "pursuit:gain=2,standoff=0.0125,cap=1", s.model());
      const task::MetricSummary m = task::Summarise(Fly(s, c, kEpisodes, 3000));
      // Four standard errors of the difference of two means, and the table's rounding.
      const auto expect = [&](const std::string& name, double expected, double rounding) {
        const auto k =
            static_cast<size_t>(std::find(m.names.begin(), m.names.end(), name) - m.names.begin());
        const double error = m.std[k] * std::sqrt(1.0 / kEpisodes + 1.0 / kReferenceEpisodes);
        EXPECT_NEAR(m.mean[k], expected, 4.0 * error + rounding)
            << name << " of " << (tuned ? "tuned" : "simple") << " on " << row.scenario << ", "
            << row.condition << " (standard error " << error << ")";
      };
      expect("return", tuned ? row.tuned_return : row.simple_return, 0.05);
      expect("tail_distance", tuned ? row.tuned_distance : row.simple_distance, 0.00005);
      expect("colliding_pairs", tuned ? row.tuned_pairs : row.simple_pairs, 0.005);
    }
  }
}

TEST(PursuitSeparated, HoldsTheBandWithoutContactOnTrueStates) {
  const Scenario s = Shipped("medium_release");
  const auto separated = Fly(s, agent::MakeDecider("pursuit_separated", s.model()), 28, 3000);
  const task::MetricSummary m = task::Summarise(separated);
  const auto mean = [&](const std::string& name) {
    double sum = 0.0;
    for (const auto& e : separated) sum += Value(e, name) / 28.0;
    return sum;
  };
  EXPECT_EQ(mean("tail_colliding_pairs"), 0.0);
  EXPECT_GT(mean("return"), 1005.0);
  EXPECT_GT(mean("band_rate"), 0.9);
  EXPECT_LT(mean("tail_distance"), 0.015);
  EXPECT_EQ(m.episodes, 28);
}

TEST(Pursuit, InAcousticModeUsesTheAgentsEstimatesOnly) {
  // With a useless cue and without sensing, the controller cannot find the target.
  const std::vector<std::string> blind = {"sensing.range_m=0.02", "sensing.cue_std_m=0.2"};
  const Scenario acoustic = Short(Shipped("medium", "nominal", blind), 150);
  Scenario truth = acoustic;
  truth.mode = InformationMode::kTruth;
  const auto a = Fly(acoustic, agent::MakeDecider("pursuit", acoustic.model()), 16, 1);
  const auto t = Fly(truth, agent::MakeDecider("pursuit", truth.model()), 16, 1);
  double error_a = 0.0, error_t = 0.0;
  for (size_t e = 0; e < a.size(); ++e) {
    error_a += a[e].tracking_error / 16.0;
    error_t += t[e].tracking_error / 16.0;
  }
  EXPECT_LT(error_t, 0.06);
  EXPECT_GT(error_a, 0.15);
}

TEST(Pursuit, InAcousticModeStillHoldsTheTargetInTheShippedScenarios) {
  for (const char* name : {"medium", "hard"}) {
    const Scenario s = Shipped(name);
    const task::MetricSummary m =
        task::Summarise(Fly(s, agent::MakeDecider("pursuit", s.model()), 12, 3000));
    const auto k = static_cast<size_t>(std::find(m.names.begin(), m.names.end(), "tail_distance") -
                                       m.names.begin());
    EXPECT_NEAR(m.mean[k], 0.0125, 0.0005) << name;  // the standoff, and the error of the track
  }
}

TEST(Shipped, PoliciesDoWhatTheyAreShippedFor) {
  const struct {
    const char* name;
    double least_return, most_error;
  } rows[] = {{"medium", 1042.0, 0.0004}, {"hard", 1036.0, 0.0007}};
  for (const auto& row : rows) {
    SCOPED_TRACE(row.name);
    const Scenario s = Shipped(row.name);
    const std::string file = config::ScenarioFolder() + "/../policies/" + row.name + ".onnx";
    // This test can refuse a policy, so it chooses. It must not use the reporting block.
    const auto episodes = Fly(s, agent::MakeDecider(file, s.model()), 28, 3000);
    ASSERT_EQ(SeedBlockOf(3000, 28), "choosing");
    const task::MetricSummary m = task::Summarise(episodes);
    EXPECT_GT(m.Mean("return"), row.least_return);
    EXPECT_LT(m.Mean("tracking_error"), row.most_error);
    EXPECT_EQ(m.Mean("lost_rate"), 0.0);
    EXPECT_LT(m.Mean("tail_colliding_pairs"), 0.05);
  }
}

TEST(SeedBlocks, AreDisjointAndKnown) {
  EXPECT_LT(kChoosingSeeds.last, kReportingSeeds.first);
  EXPECT_LT(kReportingSeeds.last, kTrainingSeeds.first);
  EXPECT_EQ(SeedBlockOf(3000, 30), "choosing");
  EXPECT_EQ(SeedBlockOf(kReportingSeeds.first, 100), "reporting");
  EXPECT_EQ(SeedBlockOf(kReportingSeeds.last, 1), "reporting");
  EXPECT_EQ(SeedBlockOf(kReportingSeeds.last, 2), "no");
  EXPECT_EQ(SeedBlockOf(kChoosingSeeds.last, 2), "no");
  EXPECT_EQ(SeedBlockOf(kTrainingSeeds.last, 2), "no");  // wraps around
  EXPECT_EQ(SeedBlockOf(2'000'000'000, 1), "training");
}

TEST(Idle, DoesNotMove) {
  const Scenario s = Short(Shipped("medium"), 50);
  for (const auto& e : Fly(s, agent::MakeDecider("idle", s.model()), 4, 3000)) {
    EXPECT_EQ(e.action_norm, 0.0);
    EXPECT_EQ(e.control_cost, 0.0);
    EXPECT_NEAR(e.time_to_band, 5.0, 1e-9);
    EXPECT_GE(e.min_separation, s.world.reset.min_separation_m - 1e-6);
  }
}

TEST(Evaluation, APrivilegedControllerActsOnTrueStatesInAcousticMode) {
  const auto actions = [](const char* mode, bool privileged) {
    const Scenario s = LoadNamedScenario(config::ScenarioFolder(), "medium", "nominal",
                                         {std::string("mode=") + mode});
    VectorEnv env(s, VectorEnvOptions());
    EnvMemory memory = env.MakeMemory();
    env.Reset(memory.arrays());
    agent::Decider controller = agent::MakeDecider("pursuit_separated", s.model());
    controller.privileged = privileged;
    std::vector<double> a(static_cast<size_t>(env.envs() * env.agents() * env.action_size()));
    Decide(controller, env, memory.observations.data(), a.data());
    return a;
  };
  EXPECT_EQ(actions("acoustic", true), actions("truth", false));
  EXPECT_NE(actions("acoustic", false), actions("truth", false));  // a cue is wrong by 5 cm
}

}  // namespace
}  // namespace stg::env

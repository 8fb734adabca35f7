// The nodes in lockstep fly exactly the same episodes as the environment in one process.

#include <auv_msgs/AgentStep.h>
#include <auv_msgs/EpisodeSummary.h>
#include <auv_msgs/StepReport.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "stg_agent/nodes/topics.hpp"
#include "stg_env/env/evaluation.hpp"

namespace stg::nodes {
namespace {

constexpr TimeNs kFirstStamp = 1'000'000'000;
/// Tolerance of metrics. The nodes divide a wrench by the limits to get the shares back, and this
/// rounds.
constexpr double kTolerance = 1e-12;
constexpr int kEpisodes = 2;

/// What the nodes published, by the index of the stamp (steps 0 to T of each episode in a row).
struct Flight {
  std::map<int, std::vector<dynamics::NavState>> states;
  std::map<int, std::vector<auv_msgs::AgentStep>> decisions;
  std::map<int, auv_msgs::StepReport> reports;
  std::map<std::uint32_t, auv_msgs::EpisodeSummary> summaries;
};

/// Listens until all messages of kEpisodes have come or a minute has passed.
/// @param silent AUV whose agent does not tell what it sees and decides; -1: none
Flight Listen(const Scenario& s, int silent) {
  Flight flight;
  const double period = s.run.decision_dt_s() * 1e9;
  const auto index_of = [period](const ros::Time& t) {
    return static_cast<int>(std::llround(static_cast<double>(NsOf(t) - kFirstStamp) / period));
  };
  const auto agents = static_cast<std::size_t>(s.run.agents);
  const int telling = silent < 0 ? s.run.agents : s.run.agents - 1;
  int missing = kEpisodes * s.run.time.episode_steps * (s.run.agents + telling);
  // The test does not compare the state after the last step, because nothing is decided there. It
  // does not compare later episodes: one AUV may begin them before the last messages of another AUV
  // come.
  const auto count = [&](int index) {
    const bool compared = index < kEpisodes * (s.run.time.episode_steps + 1) &&
                          index % (s.run.time.episode_steps + 1) < s.run.time.episode_steps;
    missing -= compared ? 1 : 0;
  };
  ros::NodeHandle node;
  std::vector<ros::Subscriber> subscribers;
  for (int i = 0; i < s.run.agents; ++i) {
    const boost::function<void(const nav_msgs::Odometry::ConstPtr&)> callback =
        [&, i](const nav_msgs::Odometry::ConstPtr& m) {
          // Odometry between two decisions is for autopilots only.
          if ((NsOf(m->header.stamp) - kFirstStamp) % s.run.decision_period() != 0) return;
          const int index = index_of(m->header.stamp);
          auto& states = flight.states[index];
          states.resize(agents);
          dynamics::NavState& state = states[static_cast<std::size_t>(i)];
          // An AUV that connects at this time gets a step twice.
          if (state.stamp == 0) count(index);
          state = NavOf(*m, 0);
        };
    subscribers.push_back(
        node.subscribe<nav_msgs::Odometry>(topics::AuvTopic(i, topics::kOdom), 0, callback));
    if (i == silent) continue;
    const boost::function<void(const auv_msgs::AgentStep::ConstPtr&)> on_decision =
        [&, i](const auv_msgs::AgentStep::ConstPtr& m) {
          const int index = index_of(m->header.stamp);
          auto& decisions = flight.decisions[index];
          decisions.resize(agents);
          auv_msgs::AgentStep& decision = decisions[static_cast<std::size_t>(i)];
          if (decision.observation.empty()) count(index);
          decision = *m;
        };
    subscribers.push_back(node.subscribe<auv_msgs::AgentStep>(
        topics::AuvTopic(i, topics::kAgentStep), 0, on_decision));
  }
  const boost::function<void(const auv_msgs::StepReport::ConstPtr&)> on_report =
      [&](const auv_msgs::StepReport::ConstPtr& m) {
        flight.reports[index_of(m->header.stamp)] = *m;
      };
  subscribers.push_back(node.subscribe<auv_msgs::StepReport>(topics::kStepReport, 0, on_report));
  const boost::function<void(const auv_msgs::EpisodeSummary::ConstPtr&)> on_summary =
      [&](const auv_msgs::EpisodeSummary::ConstPtr& m) { flight.summaries[m->episode] = *m; };
  subscribers.push_back(
      node.subscribe<auv_msgs::EpisodeSummary>(topics::kEpisodeSummary, 0, on_summary));
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(50.0);
  const auto reports = static_cast<std::size_t>(kEpisodes * s.run.time.episode_steps);
  while (ros::ok() && ros::WallTime::now() < end &&
         (missing > 0 || flight.summaries.size() < kEpisodes || flight.reports.size() < reports)) {
    HandleMessages(0.1);
  }
  EXPECT_EQ(missing, 0) << "states and decisions that did not arrive";
  return flight;
}

double Distance(const Vec3<double>& a, const Vec3<double>& b) { return Norm(a - b); }

/// Compares what an AUV saw and did in one step with what it sees and does in the environment.
void ExpectDecision(const auv_msgs::AgentStep& flown, const env::VectorEnv& env, int i,
                    const std::vector<float>& observations, const std::vector<double>& actions) {
  const int width = env.observation_size(), size = env.action_size();
  const auto seen = observations.begin() + i * width;
  EXPECT_EQ(flown.observation, std::vector<float>(seen, seen + width)) << "AUV " << i;
  const auto done = actions.begin() + i * size;
  EXPECT_EQ(flown.action, std::vector<float>(done, done + size)) << "AUV " << i;
}

bool AtWall(const Vec3<double>& p, double half_extent_m) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) == half_extent_m;
}

TEST(Parity, GraphInLockstepFliesTheEpisodesOfTheEnvironment) {
  const Scenario s = LoadScenarioParameters<Scenario>(config::Scope::kWhole);
  const auto seed = static_cast<std::uint64_t>(IntegerParameter("seed", 0, 0, 2147483647));
  const agent::Decider controller = agent::MakeDecider(TextParameter("policy", ""), s.model());
  const int silent = IntegerParameter("silent", -1, -1, s.run.agents - 1);
  const Flight flight = Listen(s, silent);
  ASSERT_GE(flight.summaries.size(), static_cast<std::size_t>(kEpisodes));

  const int steps = s.run.time.episode_steps;
  int at_wall = 0;
  for (int e = 0; e < kEpisodes; ++e) {
    env::VectorEnvOptions env_options;
    env_options.seed = seed + static_cast<std::uint64_t>(e);
    env_options.envs = 1;
    env::VectorEnv env(s, env_options);
    env::EnvMemory memory = env.MakeMemory();
    env.Reset(memory.arrays());
    std::vector<double> actions(static_cast<std::size_t>(s.run.agents * env.action_size()));
    double worst = 0.0;
    for (int k = 0; k < steps; ++k) {
      const int index = e * (steps + 1) + k;
      const auto found = flight.states.find(index);
      ASSERT_NE(found, flight.states.end()) << "episode " << e << ", step " << k;
      for (int i = 0; i < s.run.agents; ++i) {
        const dynamics::NavState truth = env.navigation(0, i);
        const dynamics::NavState& flown = found->second[static_cast<std::size_t>(i)];
        worst = std::max(worst, Distance(truth.p_WB, flown.p_WB));
        worst = std::max(worst, Distance(truth.v_WB_B, flown.v_WB_B));
        at_wall += AtWall(truth.p_WB, s.world.workspace.half_extent_m) ? 1 : 0;
        ASSERT_EQ(worst, 0.0) << "episode " << e << ", step " << k << ", AUV " << i;
      }
      env::Decide(controller, env, memory.observations.data(), actions.data());
      const auto decisions = flight.decisions.find(index);
      ASSERT_NE(decisions, flight.decisions.end()) << "episode " << e << ", step " << k;
      for (int i = 0; i < s.run.agents; ++i) {
        if (i == silent) continue;
        ExpectDecision(decisions->second[static_cast<std::size_t>(i)], env, i, memory.observations,
                       actions);
      }
      ASSERT_FALSE(HasFailure()) << "episode " << e << ", step " << k;
      const std::vector<float> state = memory.states;
      env.Step(actions.data(), memory.arrays());
      const auto report = flight.reports.find(index + 1);
      ASSERT_NE(report, flight.reports.end()) << "episode " << e << ", step " << k;
      EXPECT_NEAR(report->second.reward, memory.team_rewards[0], 1e-6);
      ASSERT_EQ(report->second.global_state.size(), state.size());
      for (std::size_t f = 0; f < state.size(); ++f) {
        ASSERT_NEAR(report->second.global_state[f], state[f], 1e-5) << "feature " << f;
      }
    }
    ASSERT_TRUE(memory.truncated[0]);
    const task::EpisodeMetrics& m = env.metrics(0);
    const auv_msgs::EpisodeSummary& summary = flight.summaries.at(static_cast<std::uint32_t>(e));
    EXPECT_TRUE(summary.complete);
    EXPECT_EQ(summary.deadline_misses, 0U);
    EXPECT_EQ(summary.seed, env_options.seed);
    auto items = m.Items();
    // The metrics node hears no pings, and not what an AUV knows of its own position.
    const std::set<std::string> unheard{"navigation_rmse",
                                        "navigation_rmse_tail",
                                        "navigation_nees",
                                        "relative_rmse",
                                        "fixes",
                                        "surface_share",
                                        "navigation_rmse_before_fix",
                                        "pings",
                                        "ping_loss",
                                        "airtime_share"};
    items.erase(std::remove_if(items.begin(), items.end(),
                               [&](const auto& item) { return unheard.count(item.first) > 0; }),
                items.end());
    ASSERT_EQ(summary.metric_names.size(), items.size());
    // The environment also counts packets of stations. The nodes count those among AUVs only.
    const bool stations = FlagParameter("stations", false);
    for (std::size_t k = 0; k < items.size(); ++k) {
      EXPECT_EQ(summary.metric_names[k], items[k].first);
      if (stations && items[k].first.rfind("packet", 0) == 0) continue;
      EXPECT_NEAR(summary.metrics[k], items[k].second, 1e-6 * (1.0 + std::abs(items[k].second)))
          << items[k].first;
    }
    EXPECT_NEAR(summary.episode_return, m.episode_return, 1e-6);
    EXPECT_NEAR(summary.tail_distance, m.tail_distance, kTolerance);
    EXPECT_NEAR(summary.tracking_error, m.tracking_error, kTolerance);
    EXPECT_NEAR(summary.lost_rate, m.lost_rate, kTolerance);
    EXPECT_NEAR(summary.action_norm, m.action_norm, kTolerance);
    EXPECT_NEAR(summary.saturation_rate, m.saturation_rate, kTolerance);
    EXPECT_NEAR(summary.control_cost, m.control_cost, kTolerance);
    EXPECT_NEAR(summary.communication_quality, m.communication_quality, kTolerance);
    EXPECT_NEAR(summary.band_rate, m.band_rate, kTolerance);
    EXPECT_NEAR(summary.colliding_pairs, m.colliding_pairs, kTolerance);
    EXPECT_NEAR(summary.tail_colliding_pairs, m.tail_colliding_pairs, kTolerance);
    EXPECT_NEAR(summary.min_separation, m.min_separation, kTolerance);
    EXPECT_NEAR(summary.time_to_band, m.time_to_band, kTolerance);
    ASSERT_EQ(summary.field != 0, m.field.has_value());
    if (m.field) {
      const task::FieldMetrics& f = *m.field;
      EXPECT_NEAR(summary.estimate_rmse, f.estimate_rmse, kTolerance);
      EXPECT_NEAR(summary.nees, f.nees, kTolerance * (1.0 + f.nees));
      EXPECT_NEAR(summary.estimate_known, f.estimate_known, kTolerance);
      EXPECT_NEAR(summary.information_age, f.information_age, kTolerance);
      EXPECT_NEAR(summary.band_share, f.band_share, kTolerance);
      EXPECT_NEAR(summary.time_lost, f.time_lost, kTolerance);
      EXPECT_NEAR(summary.time_to_reacquire, f.time_to_reacquire, kTolerance);
      EXPECT_NEAR(summary.losses, f.losses, kTolerance);
      EXPECT_NEAR(summary.spread, f.spread, kTolerance);
      EXPECT_NEAR(summary.near_pairs, f.near_pairs, kTolerance);
      EXPECT_NEAR(summary.min_altitude, f.min_altitude, kTolerance);
      EXPECT_NEAR(summary.min_clearance, f.min_clearance, kTolerance);
      EXPECT_EQ(summary.groundings, f.groundings);
      EXPECT_EQ(summary.collisions, f.collisions);
      if (!stations) {
        EXPECT_NEAR(summary.packets, f.packets, kTolerance);
        EXPECT_NEAR(summary.packet_loss, f.packet_loss, kTolerance);
      }
      EXPECT_EQ(summary.modem_energy, f.modem_energy);
      if (FlagParameter("surfaces", false)) {
        ASSERT_TRUE(f.navigation && f.navigation->surfacing);
        EXPECT_GT(f.navigation->surfacing->fixes, 0.0);
      }
    }
    RecordProperty("worst_difference_" + std::to_string(e), std::to_string(worst));
    std::printf("episode %d: largest difference %.3g\n", e, worst);
  }
  std::printf("decisions of AUVs at a wall: %d\n", at_wall);
  if (FlagParameter("walls", false)) {
    EXPECT_GT(at_wall, 0);
  }
}

}  // namespace
}  // namespace stg::nodes

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "parity");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}

// Agents that explore. They record what they flew, with the probability that their policy gives it.
// A seed makes the same episode whenever it is flown.

#include <auv_msgs/AgentStep.h>
#include <auv_msgs/Reset.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "stg_agent/nodes/topics.hpp"
#include "stg_agent/policy/policy.hpp"
#include "stg_env/env/vector_env.hpp"

namespace stg::nodes {
namespace {

constexpr double kTolerance = 1e-9;

/// What the AUVs recorded, and where they were.
struct Episode {
  std::map<std::uint32_t, std::vector<auv_msgs::AgentStep>> records;  ///< [step][agents]
  std::map<std::uint32_t, std::vector<dynamics::NavState>> states;    ///< [step][agents]
};

/// Hears every AUV.
class Listener {
 public:
  explicit Listener(const Scenario& s) : agents_(static_cast<std::size_t>(s.run.agents)) {
    ros::NodeHandle node;
    for (std::size_t i = 0; i < agents_; ++i) {
      const int id = static_cast<int>(i);
      const boost::function<void(const auv_msgs::AgentStep::ConstPtr&)> on_step =
          [this, i](const auv_msgs::AgentStep::ConstPtr& m) {
            auto& row = steps_[m->header.stamp];
            row.resize(agents_);
            row[i] = m;
          };
      const boost::function<void(const nav_msgs::Odometry::ConstPtr&)> on_odometry =
          [this, i](const nav_msgs::Odometry::ConstPtr& m) {
            auto& row = odometry_[m->header.stamp];
            row.resize(agents_);
            row[i] = m;
          };
      subscribers_.push_back(node.subscribe<auv_msgs::AgentStep>(
          topics::AuvTopic(id, topics::kAgentStep), 0, on_step));
      subscribers_.push_back(
          node.subscribe<nav_msgs::Odometry>(topics::AuvTopic(id, topics::kOdom), 0, on_odometry));
    }
  }

  /// The episode of this number. A step is in it if the messages of all AUVs have come.
  Episode Find(std::uint32_t number) const {
    Episode episode;
    for (const auto& [stamp, row] : steps_) {
      const auto odometry = odometry_.find(stamp);
      const auto here = [](const auto& messages) {
        return std::all_of(messages.begin(), messages.end(), [](const auto& m) { return bool(m); });
      };
      if (!here(row) || odometry == odometry_.end() || !here(odometry->second)) continue;
      if (row[0]->episode != number) continue;
      for (std::size_t i = 0; i < agents_; ++i) {
        episode.records[row[0]->step].push_back(*row[i]);
        episode.states[row[0]->step].push_back(NavOf(*odometry->second[i], 0));
      }
    }
    return episode;
  }

  /// Listens until the episode `number` is complete or 20 s have passed.
  Episode WaitFor(std::uint32_t number, int steps) const {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(20.0);
    Episode episode;
    while (ros::ok() && ros::WallTime::now() < end) {
      HandleMessages(0.1);
      episode = Find(number);
      if (episode.records.size() > static_cast<std::size_t>(steps)) break;
    }
    return episode;
  }

 private:
  std::size_t agents_;
  std::map<ros::Time, std::vector<auv_msgs::AgentStep::ConstPtr>> steps_;
  std::map<ros::Time, std::vector<nav_msgs::Odometry::ConstPtr>> odometry_;
  std::vector<ros::Subscriber> subscribers_;
};

/// Two episodes of one seed: the first one of the run, and one that a reset asks for later.
class Explore : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scenario_ = new Scenario(LoadScenarioParameters<Scenario>(config::Scope::kWhole));
    seed_ = static_cast<std::uint64_t>(IntegerParameter("seed", 0, 0, 1 << 30));
    const Listener listener(*scenario_);
    first_ = new Episode(listener.WaitFor(0, scenario_->run.time.episode_steps));
    auv_msgs::Reset call;
    call.request.seed = seed_;
    call.request.use_seed = true;
    ASSERT_TRUE(ros::service::call(topics::kReset, call) && call.response.success);
    ASSERT_GT(call.response.episode, 0U);
    again_ =
        new Episode(listener.WaitFor(call.response.episode, scenario_->run.time.episode_steps));
  }

  void SetUp() override {
    const auto steps = static_cast<std::size_t>(scenario_->run.time.episode_steps) + 1;
    ASSERT_EQ(first_->records.size(), steps);
    ASSERT_EQ(again_->records.size(), steps);
  }

  inline static Scenario* scenario_ = nullptr;
  inline static Episode* first_ = nullptr;
  inline static Episode* again_ = nullptr;
  inline static std::uint64_t seed_ = 0;
};

TEST_F(Explore, LogProbabilityIsThatOfThePolicysGaussian) {
  const agent::Policy policy = agent::Policy::LoadOnnx(TextParameter("policy", ""));
  const Eigen::VectorXf& log_std = policy.parameters().log_std;
  double squares = 0.0;
  int count = 0;
  for (const auto& [step, row] : first_->records) {
    for (const auv_msgs::AgentStep& m : row) {
      ASSERT_EQ(m.policy_id, policy.metadata().id);
      ASSERT_EQ(m.action.size(), static_cast<std::size_t>(policy.action_size()));
      std::vector<float> mean(m.action.size());
      policy.Mean(m.observation.data(), mean.data());
      double expected = 0.0;
      for (std::size_t a = 0; a < mean.size(); ++a) {
        const double std = std::exp(static_cast<double>(log_std[static_cast<Eigen::Index>(a)]));
        const double z = (static_cast<double>(m.action[a]) - static_cast<double>(mean[a])) / std;
        expected += std::log(std::exp(-0.5 * z * z) / (std * std::sqrt(2.0 * M_PI)));
        squares += z * z;
        ++count;
      }
      ASSERT_NEAR(m.log_probability, expected, 1e-3) << "step " << step << ", AUV " << m.agent;
    }
  }
  // The mean of n squared standard normal numbers has standard deviation sqrt(2 / n).
  EXPECT_NEAR(squares / count, 1.0, 5.0 * std::sqrt(2.0 / count));
}

TEST_F(Explore, TheRecordedActionsFlyTheRecordedEpisode) {
  env::VectorEnvOptions options;
  options.seed = seed_;
  options.envs = 1;
  env::VectorEnv env(*scenario_, options);
  env::EnvMemory memory = env.MakeMemory();
  env.Reset(memory.arrays());
  const auto size = static_cast<std::size_t>(env.action_size());
  const auto width = static_cast<std::size_t>(env.observation_size());
  const auto agents = static_cast<std::size_t>(env.agents());
  std::vector<float> actions(agents * size);
  for (int k = 0; k < scenario_->run.time.episode_steps; ++k) {
    const auto& row = first_->records.at(static_cast<std::uint32_t>(k));
    for (std::size_t i = 0; i < agents; ++i) {
      const dynamics::NavState truth = env.nav(0, static_cast<int>(i));
      const dynamics::NavState& flown = first_->states.at(static_cast<std::uint32_t>(k))[i];
      ASSERT_LE(Norm(truth.p_WB - flown.p_WB), kTolerance) << "step " << k << ", AUV " << i;
      ASSERT_LE(Norm(truth.v_WB_B - flown.v_WB_B), kTolerance) << "step " << k << ", AUV " << i;
      const float* observation = memory.observation(0, static_cast<int>(i));
      ASSERT_TRUE(std::equal(row[i].observation.begin(), row[i].observation.end(), observation,
                             observation + width))
          << "step " << k << ", AUV " << i;
      std::copy(row[i].action.begin(), row[i].action.end(),
                actions.begin() + static_cast<std::ptrdiff_t>(i * size));
    }
    env.Step(actions.data(), memory.arrays());
  }
}

TEST_F(Explore, TheSameSeedGivesTheSameEpisodeAndAgentsDrawApart) {
  for (const auto& [step, row] : first_->records) {
    const auto& other = again_->records.at(step);
    for (std::size_t i = 0; i < row.size(); ++i) {
      ASSERT_EQ(row[i].observation, other[i].observation) << "step " << step << ", AUV " << i;
      ASSERT_EQ(row[i].action, other[i].action) << "step " << step << ", AUV " << i;
      ASSERT_EQ(row[i].log_probability, other[i].log_probability);
      ASSERT_EQ(first_->states.at(step)[i].p_WB.x, again_->states.at(step)[i].p_WB.x);
    }
    EXPECT_NE(row[0].action, row[1].action) << "step " << step;
  }
}

}  // namespace
}  // namespace stg::nodes

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "explore");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}

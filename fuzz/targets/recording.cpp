#include <vector>

#include "marl_trainer/learn/recorded/recorded.hpp"
#include "stg_env/scenario/scenario.hpp"
#include "target.hpp"

namespace stg::fuzz {
namespace {

/// Up to 255 numbers; the first byte is their count.
std::vector<float> TakeNumbers(Bytes* in) {
  std::vector<float> numbers(in->Take<std::uint8_t>());
  for (float& number : numbers) number = in->Take<float>();
  return numbers;
}

agent::Policy MakePolicy(const Scenario& scenario) {
  agent::Policy::Parameters p;
  const int inputs = scenario.agent.observation_size(),
            outputs = scenario.world.control.action_size();
  p.input_mean = Eigen::VectorXf::Zero(inputs);
  p.input_std = Eigen::VectorXf::Ones(inputs);
  p.layers.push_back({Eigen::MatrixXf::Zero(outputs, inputs), Eigen::VectorXf::Zero(outputs)});
  p.log_std = Eigen::VectorXf::Zero(outputs);
  p.metadata.id = "p";
  return agent::Policy(std::move(p));
}

}  // namespace

/// The messages of a recorded run, as the trainer's node passes them on, in any order. True if an
/// episode was complete.
bool RunRecording(const std::string& bytes) {
  static const Scenario scenario =
      LoadNamedScenario(STG_SCENARIOS, "medium", "nominal",
                        {"agents=1", "time.episode_steps=2", "time.tail_steps=1"});
  static const agent::Policy policy = MakePolicy(scenario);
  static const learn::EpisodeChecker checker(scenario.run, scenario.agent.observation, 2, policy);
  learn::EpisodeAssembler assembler(scenario.run, "fuzz");
  Bytes in(bytes);
  bool whole = false;
  const auto judge = [&](const std::vector<learn::RecordedEpisode>& episodes) {
    for (const learn::RecordedEpisode& episode : episodes) {
      whole = whole || episode.Complete(scenario.run.time.episode_steps);
      const learn::Finding finding = checker.Check(episode);
      Require(finding.flaw != learn::Flaw::kCount, "a flaw without a name");
      Require(
          finding.flaw != learn::Flaw::kNone || episode.Complete(scenario.run.time.episode_steps),
          "an episode with gaps was accepted");
    }
  };
  while (!in.empty()) {
    const auto kind = in.Take<std::uint8_t>();
    const auto episode = in.Take<std::uint32_t>();
    const auto start = in.Take<TimeNs>();
    const auto step = in.Take<std::uint32_t>();
    if (kind % 3 == 0) {
      learn::AgentRecord record;
      record.layout_version = in.Take<std::uint32_t>();
      record.log_probability = in.Take<float>();
      record.policy_id = std::string(1, static_cast<char>(in.Take<std::uint8_t>()));
      record.observation = TakeNumbers(&in);
      record.action = TakeNumbers(&in);
      assembler.Add(episode, start, step, 0, std::move(record));
    } else if (kind % 3 == 1) {
      learn::RewardRecord record;
      record.reward = in.Take<double>();
      record.truncated = in.Take<std::uint8_t>() % 2 == 1;
      record.state = TakeNumbers(&in);
      record.final_state = TakeNumbers(&in);
      assembler.Add(episode, start, step, std::move(record));
    } else {
      judge(assembler.TakeDone());
    }
  }
  judge(assembler.TakeAll());
  return whole;
}

}  // namespace stg::fuzz

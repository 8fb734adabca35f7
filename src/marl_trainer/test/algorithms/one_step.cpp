#include "algorithms/one_step.hpp"

#include <stdexcept>

namespace stg::learn {
namespace {

TrainSetup StepSetup(const std::string& algorithm, int batch, const nlohmann::json& options) {
  nlohmann::json all = {{"gamma", OneStep::kGamma},
                        {"n-step", 1},
                        {"batch", batch},
                        {"replayed", static_cast<double>(batch) / OneStep::kEnvs},
                        {"warmup", 0},
                        {"activation", "tanh"},
                        {"lr", 1e-8},
                        {"grad-clip", 1e6}};
  if (algorithm != "madqn") all["critic-lr"] = 1e-8;
  all.update(options);
  return GameSetup(algorithm, all);
}

Problem Pair() {
  Problem problem;
  problem.agents = OneStep::kAgents;
  problem.observation_size = OneStep::kSeen;
  problem.state_size = OneStep::kState;
  problem.action_size = OneStep::kAction;
  problem.action_scale = OneStep::kScale;
  return problem;
}

/// Moments of numbers with mean 0 and deviation 1. They are so many that a few more change nothing.
std::vector<double> PlainMoments(int size) {
  constexpr double kMany = 1e12;
  std::vector<double> moments(static_cast<std::size_t>(1 + size), 0.0);
  moments[0] = kMany;
  moments.resize(static_cast<std::size_t>(1 + 2 * size), kMany);
  return moments;
}

std::vector<float> ForAll(const std::vector<float>& one, float factor = 1.0F) {
  std::vector<float> all;
  for (int e = 0; e < OneStep::kEnvs; ++e) {
    for (const float x : one) all.push_back(factor * x);
  }
  return all;
}

}  // namespace

OneStep::OneStep(const std::string& algorithm, int batch, const nlohmann::json& options)
    : seen(Draw(kAgents * kSeen, 1.0F, 1)),
      state(Draw(kState, 1.0F, 2)),
      actions{0.0F, 1.0F, -1.0F, 0.0F},  // these are bins of three
      next_seen(Draw(kAgents * kSeen, 1.0F, 3)),
      next_state(Draw(kState, 1.0F, 4)),
      final_seen(Draw(kAgents * kSeen, 1.0F, 5)),
      final_state(Draw(kState, 1.0F, 6)),
      setup_(StepSetup(algorithm, batch, options)),
      algorithm_(setup_.own->Make(setup_.common, Pair(), &pool_)) {
  arrays_ = Save().arrays();
  arrays_["observation_moments"] = PlainMoments(kSeen);
  arrays_["state_moments"] = PlainMoments(kState);
  arrays_["reward_moments"] = PlainMoments(1);
}

void OneStep::Shake(const std::vector<std::string>& names) {
  unsigned seed = 100;
  for (const std::string& name : names) {
    (*this)[name] = Draw((*this)[name].size(), 0.4F, ++seed);
  }
}

void OneStep::Load() {
  Archive archive;
  for (const auto& [name, array] : arrays_) archive.Put(name, array);
  algorithm_->Load(archive);
}

void OneStep::Update() {
  Collection collection;
  collection.number = updates_++;
  collection.steps = 1;
  collection.shards = {{0, kEnvs}};
  algorithm_->Begin(collection);
  const auto scale = static_cast<float>(kScale);
  const std::vector<float> all_seen = ForAll(seen), all_state = ForAll(state);
  const std::vector<float> all_next_seen = ForAll(next_seen), all_next_state = ForAll(next_state);
  const std::vector<float> all_final_seen = ForAll(final_seen),
                           all_final_state = ForAll(final_state);
  const std::vector<float> all_actions = ForAll(actions, scale);
  const std::vector<float> team(kEnvs, reward), own(kEnvs * kAgents, -reward);
  const std::vector<std::uint8_t> ends(kEnvs, truncated ? 1 : 0);
  Transition t;
  t.envs = kEnvs;
  t.observations = all_seen.data();
  t.states = all_state.data();
  t.actions = all_actions.data();
  t.rewards = own.data();
  t.team_rewards = team.data();
  t.truncated = ends.data();
  t.next_observations = all_next_seen.data();
  t.next_states = all_next_state.data();
  t.final_observations = all_final_seen.data();
  t.final_states = all_final_state.data();
  algorithm_->Observe(t);
  report_ = algorithm_->Update({});
}

double OneStep::Reported(const std::string& column) const {
  const std::vector<ReportColumn> columns = algorithm_->Columns();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].name == column) return report_.values.at(i);
  }
  throw std::logic_error("no column " + column);
}

Archive OneStep::Save() const {
  Archive archive;
  algorithm_->Save(&archive);
  return archive;
}

std::vector<float> Outputs(const Mlp& network, const float* parameters, const float* input) {
  Mlp::Workspace workspace(network, 1);
  network.Forward(parameters, input, 1, &workspace);
  return {workspace.output(), workspace.output() + network.outputs()};
}

}  // namespace stg::learn

#include "marl_trainer/learn/buffers/rollout_buffer.hpp"

#include <algorithm>
#include <cassert>

namespace stg::learn {
namespace {

std::size_t Size(int a, int b = 1, int c = 1, int d = 1) {
  return static_cast<std::size_t>(a) * static_cast<std::size_t>(b) * static_cast<std::size_t>(c) *
         static_cast<std::size_t>(d);
}

}  // namespace

void RolloutBuffer::Begin(const Problem& problem, int new_steps, int new_envs, bool taught) {
  steps = new_steps;
  envs = new_envs;
  agents = problem.agents;
  observations.resize(Size(steps, envs, agents, problem.observation_size));
  actions.resize(Size(steps, envs, agents, problem.action_size));
  teacher.resize(taught ? actions.size() : 0);
  log_prob.resize(Size(steps, envs, agents));
  states.resize(Size(steps, envs, problem.state_size));
  for (auto* per_sample : {&rewards, &values, &final_values, &advantages}) {
    per_sample->resize(Size(steps, envs));
  }
  done.assign(Size(steps, envs), 0);
  bootstrap.resize(Size(envs));
  last_states.resize(Size(envs, problem.state_size));
  final_states.clear();
  final_samples.clear();
}

void RolloutBuffer::Add(const Problem& problem, const Transition& in, const Normaliser& observation,
                        const Normaliser& state) {
  assert(in.envs == envs && in.step >= 0 && in.step < steps);
  const int rows = envs * problem.agents;
  const std::size_t sample = Size(in.step, envs);
  const std::size_t action = Size(in.step, rows, problem.action_size);
  observation.Apply(in.observations, rows,
                    observations.data() + Size(in.step, rows, problem.observation_size));
  state.Apply(in.states, envs, states.data() + Size(in.step, envs, problem.state_size));
  std::copy_n(in.actions, Size(rows, problem.action_size), actions.data() + action);
  if (!teacher.empty()) {
    std::copy_n(in.teacher, Size(rows, problem.action_size), teacher.data() + action);
  }
  std::copy_n(in.log_prob, rows, log_prob.data() + Size(in.step, rows));
  std::copy_n(in.team_rewards, envs, rewards.data() + sample);
  std::copy_n(in.truncated, envs, done.data() + sample);
  for (int e = 0; e < envs; ++e) {
    if (in.truncated[e] == 0) continue;
    const std::size_t at = final_states.size();
    final_states.resize(at + Size(problem.state_size));
    state.Apply(in.final_states + Size(e, problem.state_size), 1, final_states.data() + at);
    final_samples.push_back(static_cast<int>(sample) + e);
  }
  if (in.step + 1 == steps) state.Apply(in.next_states, envs, last_states.data());
}

}  // namespace stg::learn

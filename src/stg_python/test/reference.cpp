#include <algorithm>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "auv_common/config/files.hpp"
#include "stg_env/env/vector_env.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace {

template <class Number>
void Write(const std::vector<Number>& numbers, std::ofstream* out) {
  out->write(reinterpret_cast<const char*>(numbers.data()),
             static_cast<std::streamsize>(numbers.size() * sizeof(Number)));
}

}  // namespace

/// What C++ makes of given actions. The program reads float32 [steps, envs, agents, action_size]
/// from a file. It writes observations, states, rewards, team rewards, truncated, final
/// observations and final states to another file, after the reset and after each step. It has one
/// object and one thread.
int main(int argc, char** argv) {
  if (argc < 7) {
    std::cerr << "usage: reference SCENARIO CONDITION[,CONDITION] ENVS SEED ACTIONS OUT [KEY=VALUE "
                 "...]\n";
    return 2;
  }
  const std::vector<std::string> overrides(argv + 7, argv + argc);
  std::vector<stg::Scenario> mix;
  const std::string conditions = argv[2];
  for (std::size_t from = 0; from <= conditions.size();) {
    const std::size_t end = std::min(conditions.find(',', from), conditions.size());
    mix.push_back(stg::LoadNamedScenario(stg::config::ScenarioFolder(), argv[1],
                                         conditions.substr(from, end - from), overrides));
    from = end + 1;
  }
  stg::env::VectorEnvOptions options;
  options.envs = std::stoi(argv[3]);
  options.seed = std::stoull(argv[4]);
  stg::env::VectorEnv env(mix, options);
  stg::env::EnvMemory memory = env.MakeMemory();
  std::ifstream in(argv[5], std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto* actions = reinterpret_cast<const float*>(bytes.data());
  const auto row = static_cast<std::size_t>(env.envs() * env.agents() * env.action_size());
  const std::size_t steps = bytes.size() / sizeof(float) / row;
  std::ofstream out(argv[6], std::ios::binary);
  env.Reset(memory.arrays());
  for (std::size_t k = 0;; ++k) {
    Write(memory.observations, &out);
    Write(memory.states, &out);
    Write(memory.rewards, &out);
    Write(memory.team_rewards, &out);
    Write(memory.truncated, &out);
    Write(memory.final_observations, &out);
    Write(memory.final_states, &out);
    if (k == steps) break;
    env.Step(actions + k * row, memory.arrays());
  }
  return out.flush() ? 0 : 1;
}

#include "auv_common/config/run_config.hpp"

namespace stg {

using config::kNone;
using config::Within;

void Describe(TimeConfig* c, config::Table* t) {
  t->Section("time");
  t->Add("dt_s", &c->dt_s, config::Within(1e-4, 1.0), "s",
         "physics step, a whole number of nanoseconds");
  t->Add("decision_steps", &c->decision_steps, config::Within(1, 1000), "physics steps",
         "length of one decision");
  t->Add("episode_steps", &c->episode_steps, config::Within(1, 1e6), "decisions",
         "episode length T");
  t->Add("tail_steps", &c->tail_steps, config::Within(1, 1e6), "decisions",
         "number of decisions at the end of an episode that the tail metrics use");
}

void DescribeTop(RunConfig* c, config::Table* t) {
  t->Section("");
  t->Add("name", &c->name, config::kNone, "-", "label of the scenario in results");
  t->Add("seed", &c->seed, config::kNone, "-",
         "seed of the network of channel.launch and of the water of emulated modems; a simulation "
         "has the seed of its command instead");
  t->Add("agents", &c->agents, config::Within(1, 255), "-", "number of AUVs N");
}

void TakeSeedFromCommand(config::Table* t) {
  config::Owner owner{
      "program", {"network"}, "seed", [] { return std::vector<std::string>{"simulation"}; }};
  owner.files_state_all = true;  // one file may serve a network and a simulation
  owner.refusal =
      "a simulation does not read this key; set the option --seed of the program, the argument "
      "seed:= of the launch file, or seed= in Python";
  t->Own("seed", owner);
}

void Describe(RunConfig* c, config::Table* t) {
  DescribeTop(c, t);
  Describe(&c->time, t);
}

std::optional<config::Violation> FindConflict(const RunConfig& c) {
  const double period_ns = c.time.dt_s * 1e9;
  if (std::abs(period_ns - std::round(period_ns)) >= 1e-6) {
    return config::Violation{{"time.dt_s"}, "must be a whole number of nanoseconds"};
  }
  if (c.time.tail_steps > c.time.episode_steps) {
    return config::Violation{{"time.tail_steps", "time.episode_steps"},
                             "the tail cannot be longer than the episode"};
  }
  return {};
}

}  // namespace stg

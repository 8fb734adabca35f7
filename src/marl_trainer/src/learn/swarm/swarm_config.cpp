#include "marl_trainer/learn/swarm/swarm_config.hpp"

#include "auv_common/error.hpp"
#include "marl_trainer/learn/options.hpp"
#include "marl_trainer/learn/swarm/network/entity_actor.hpp"

namespace stg::learn {
void SwarmConfig::Describe(config::Table* t) {
  t->Add("seed", &seed, config::kNone, "-", "seed of networks, episodes and exploration");
  t->Add("steps", &steps, {1, 1e12}, "-",
         "number of decisions of a swarm; a decision is 1 s in the field scenarios");
  t->Add(
      "action", config::Enum(&action, agent::EntityActionNames()), config::kNone, "-",
      "law5: the policy guides a law, which depends on the situation; guidance: it guides the "
      "law encircle; course3: it commands course, speed and climb rate itself; velocity3: between "
      "walls, it commands a velocity at each decision");
  t->Add("network", config::Enum(&network, agent::EntityNetworkNames()), config::kNone, "-",
         "pool: means and maxima over rows; graph: attention and messages over the task graph; it "
         "also chooses the target to follow");
  t->Add("without", config::Name(&without, BlindNames()), config::kNone, "-",
         "input that is withheld from the policy");
  t->Add(
      "free-assignment", &free_assignment, config::kNone, "-",
      "with --network graph: a quarter of the waters has two targets, among which the AUVs choose");
  t->Add("last-command", &last_command, config::kNone, "-",
         "the policy sees its last command; not useful with --noise-time above 0");
  t->Add("leaving", &leaving, config::kNone, "-",
         "in open water: in a quarter of the waters one or two AUVs leave, and one of them joins "
         "again");
  t->Add("waters", config::TextRef{&waters}, config::kNone, "-",
         "own kinds of waters in place of the mixture: name:condition:AUVs:targets, with commas "
         "between them; what is left out is the scenario's own");
  t->Add("envs", &envs, {8, 4096}, "-", "environments, eight for each kind of waters");
  t->Add("horizon", &horizon, {1, 10000}, "-",
         "commands between two updates; one lasts 5 s, or a decision if that is longer; with "
         "--action velocity3 a decision");
  t->Add("segment", &segment, {1, 100000}, "-", "updates between two checkpoints");
  t->Add("episode-steps", &episode_steps, {1, 1e6}, "-", "decisions of a training episode");
  t->Add("gamma", &gamma, config::kFraction, "-", "discount per command");
  t->Add("lambda", &lambda, config::kFraction, "-", "GAE's lambda");
  t->Add("own-reward", &own_reward, config::kFraction, "-",
         "share of an AUV's own reward in what it learns from; the rest is the mean of its team");
  t->Add("band", &band, {0, 100}, "-", "reward of a decision inside the band");
  t->Add("shaping", &shaping, {0, 100}, "-", "weight of the shaping by the distance to the band");
  t->Add("epochs", &epochs, {1, 1000}, "-", "passes over the collected rows per update");
  t->Add("minibatch", &minibatch, {1, 1e9}, "-", "rows of AUVs per gradient step");
  t->Add("learning-rate", &learning_rate, {1e-8, 1}, "-", "Adam's learning rate at the start");
  t->Add("last-learning-rate", &last_learning_rate, {0, 1}, "-",
         "learning rate at the end (linear)");
  t->Add("critic-learning-rate", &critic_learning_rate, {0, 1}, "-",
         "constant learning rate of the critic; 0: that of the actor");
  t->Add("clip", &clip, {1e-3, 10}, "-", "PPO's clip of the probability ratio");
  t->Add("target-kl", &target_kl, {0, 100}, "-", "KL divergence at which an update ends early");
  t->Add("grad-clip", &gradient_norm, {1e-6, 1e6}, "-", "largest gradient norm");
  t->Add("adam-eps", &adam_eps, {1e-12, 1}, "-", "Adam's epsilon");
  t->Add("log-std", &log_std, {-20, 2}, "-",
         "log sigma of the exploration at the start, also after --start-from");
  t->Add("min-log-std", &least_log_std, {-20, 2}, "-", "lower bound of log sigma");
  t->Add("max-log-std", &most_log_std, {-20, 2}, "-", "upper bound of log sigma");
  t->Add("noise-time", &noise_time_s, {0, agent::EntityPolicy::kMaxNoiseTime_s}, "s",
         "correlation time of the exploration; 0: each command has noise of its own");
  t->Add("average", &average, {1, 1e6}, "-",
         "number of updates over which the parameters of the written policy are averaged");
  t->Add("entropy", &entropy, {0, 10}, "-",
         "with --network graph: weight of the entropy of the choices of a target, at the start");
  t->Add("last-entropy", &last_entropy, {0, 10}, "-",
         "with --network graph: weight of this entropy at the end");
  t->Add("value-memory", &value_memory, {1, 1e12}, "-",
         "number of rows over which the moments of the returns are averaged");
  imitation.Describe(t);
  t->Add("validation-interval", &validation_interval, {1, 100000}, "-",
         "checkpoints between two validations");
  t->Add("validation-episodes", &validation_episodes, {1, 10000}, "-",
         "held-out episodes of each validation task");
  // Only this network makes choices, whose entropy these options weight.
  const config::Owner graph{
      "network", {agent::EntityNetworkName(agent::EntityNetwork::kGraph)}, "network", [this] {
        return std::vector<std::string>{EntityNetworkName(network)};
      }};
  for (const char* option : {"entropy", "last-entropy"}) t->Own(option, graph);
  config::Owner four{
      "waters", {"at least 4 kinds"}, "envs", [this] {
        return std::vector<std::string>{envs >= 32 ? "at least 4 kinds" : "fewer than 4 kinds"};
      }};
  four.refusal =
      "has no effect with fewer than 32 environments (--envs): AUVs leave in one of "
      "four kinds of waters, and each kind has 8 environments";
  t->Own("leaving", four);
}

void SwarmConfig::ValidateOrThrow() const {
  SwarmConfig copy(*this);  // a table refers to values that it may change
  config::Table table;
  copy.Describe(&table);
  RequireRanges(table);
  imitation.ValidateOrThrow();
  const bool velocity = action == agent::EntityAction::kVelocity3;
  RequireOption(imitation.controller.empty() || velocity, "imitate",
                "only a policy that commands a velocity can imitate a controller (--action "
                "velocity3)");
  RequireOption(waters.empty() || !velocity, "waters",
                "its waters are in open water, where the action velocity3 does not fly; --scenario "
                "names scenarios between walls");
  RequireOption(!free_assignment || !velocity, "free-assignment",
                "its waters are in open water, where the action velocity3 does not fly");
  RequireOption(!free_assignment || network == agent::EntityNetwork::kGraph, "free-assignment",
                std::string("the network '") + agent::EntityNetworkName(network) +
                    "' does not choose a target; --network graph does");
  RequireOption(without != "edges" || network == agent::EntityNetwork::kGraph, "without",
                std::string("the network '") + agent::EntityNetworkName(network) +
                    "' does not read edges; --network graph does");
  RequireOption(least_log_std <= log_std && log_std <= most_log_std, "log-std",
                "must be between --min-log-std and --max-log-std");
}

}  // namespace stg::learn

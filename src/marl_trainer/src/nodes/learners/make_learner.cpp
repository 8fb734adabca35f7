#include "make_learner.hpp"

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "../trainer_parameters.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "entity_learner.hpp"
#include "layers_learner.hpp"

namespace stg::nodes {
namespace {

const char* const kOnlyInEnvironments =
    "only a training in environments reads it, and this node learns from flights that it records";

/// auto: a network over entities in open water and for a policy over entities, otherwise layers.
std::string NetworkName(const Scenario& scenario, bool live, const std::string& start) {
  std::string network = TextParameter("network", "auto");
  if (network == "layers" || network == "pool" || network == "graph") return network;
  if (network != "auto") {
    throw UserError("parameter network: '" + network + "' is none of auto, layers, pool, graph");
  }
  const bool entities =
      start.empty() ? live && scenario.world.sea.open
                    : agent::EntityPolicy::IsOne(start) || learn::HoldsSwarmCheckpoint(start);
  return entities ? "" : "layers";
}

std::unique_ptr<OnlineLearner> MakeLayersLearner(const Scenario& scenario,
                                                 const std::string& start) {
  if (agent::EntityPolicy::IsOne(start)) {
    throw UserError("parameter network: layers, but the start policy '" + start +
                    "' is a network over entities");
  }
  for (const char* name : {"critic_updates", "log_std", "noise_time", "last_command",
                           "learning_rate", "last_learning_rate"}) {
    RefuseParameter(name, "belongs to the networks pool and graph, but the network is layers");
  }
  RefuseTrainParameters(
      {"steps", "envs", "horizon", "stagger", "start-from", "validation-interval",
       "validation-episodes", "checkpoint-interval", "lr-final", "imitate", "imitation-steps",
       "imitation-share", "imitation-focus", "privileged-teacher", "wall-units"},
      kOnlyInEnvironments);
  if (!start.empty()) {
    RefuseTrainParameters({"actor-hidden", "activation", "observation-clip"},
                          "the policy to start from (start_policy) has its own");
  }
  learn::RecordedTrainer::Options options;
  options.out = TextParameter("out", "");
  options.policy = start;
  options.workers = IntegerParameter("workers", 2, 1, 1024);
  options.log = &std::cout;
  learn::TrainSetup setup =
      learn::RecordedSetup(scenario.run, TextParameter("algorithm", learn::DefaultAlgorithm()));
  LoadTrainParameters(setup.Options());
  return std::make_unique<LayersLearner>(scenario, setup, options);
}

/// @param network pool or graph; empty: that of the start, else pool
std::unique_ptr<OnlineLearner> MakeEntityLearner(const Scenario& scenario,
                                                 const std::string& network,
                                                 const std::string& start) {
  learn::RequireRecordable(scenario.judge());
  if (TextParameter("algorithm", learn::DefaultAlgorithm()) != learn::DefaultAlgorithm()) {
    throw UserError("parameter algorithm: a network over entities learns by " +
                    learn::DefaultAlgorithm());
  }
  learn::SwarmConfig config = learn::RecordedSwarmConfig();
  const learn::SwarmStart from = learn::ReadSwarmStart(start, &config);
  const agent::EntityNetwork network_of_start = config.network;
  const agent::EntityAction action_of_start = config.action;
  if (!network.empty()) config.network = agent::EntityNetworkNamed(network);
  RefuseTrainParameters({"steps", "envs", "waters", "horizon", "segment", "episode-steps",
                         "free-assignment", "leaving", "last-learning-rate", "last-entropy",
                         "validation-interval", "validation-episodes", "imitate", "imitation-steps",
                         "imitation-share", "imitation-focus", "privileged-teacher"},
                        kOnlyInEnvironments);
  config::Table table;
  config.Describe(&table);
  learn::RecordedSwarmTrainer::Options options;
  const double lr = NumberParameter("lr", 0.0, 1e-8, 1.0);
  if (lr > 0.0) config.learning_rate = config.last_learning_rate = lr;
  const std::vector<std::string> given = LoadTrainParameters(table, {"network"});
  RefuseParameter("critic_lr", "belongs to the network layers, but the network is " +
                                   agent::EntityNetworkName(config.network) +
                                   ", whose critic learns with lr");
  const bool starts = !start.empty();
  if (starts && (config.network != network_of_start || config.action != action_of_start)) {
    throw UserError("start policy '" + start + "': has the network '" +
                    agent::EntityNetworkName(network_of_start) + "' and the action '" +
                    agent::EntityActionName(action_of_start) + "', not '" +
                    agent::EntityNetworkName(config.network) + "' and '" +
                    agent::EntityActionName(config.action) + "'");
  }
  if (std::find(given.begin(), given.end(), "log-std") != given.end()) {
    options.log_std = config.log_std;
  }
  options.out = TextParameter("out", "");
  options.critic_updates = IntegerParameter("critic_updates", from.policy ? 5 : 0, 0, 1000000);
  options.workers = IntegerParameter("workers", 2, 1, 1024);
  options.log = &std::cout;
  return std::make_unique<EntityLearner>(scenario, config, from, options);
}

}  // namespace

std::unique_ptr<OnlineLearner> MakeLearner(const Scenario& scenario, bool live) {
  if (TextParameter("out", "").empty()) throw UserError("parameter out: must name a folder");
  const std::string start = TextParameter("start_policy", "");
  const std::string network = NetworkName(scenario, live, start);
  if (network == "layers") return MakeLayersLearner(scenario, start);
  if (!live) {
    throw UserError("parameter bags: a network over entities learns from a running graph only");
  }
  return MakeEntityLearner(scenario, network, start);
}

}  // namespace stg::nodes

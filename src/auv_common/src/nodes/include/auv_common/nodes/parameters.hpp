#pragma once

#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "auv_common/config/loader.hpp"

namespace stg::nodes {

/// Where a parameter is searched. Parameters outlive the nodes and launches that set them. So no
/// other namespace between the two places is searched.
enum class Reach {
  kNode,  ///< only the node's private namespace
  kRun    ///< the private namespace, then the root: one value serves all nodes
};

/// The source of the run's scenario, from parameters of the whole run: `scenario` (name or file,
/// default medium), `condition` (default nominal), `agents` (replaces the number in the scenario;
/// 0: does not) and `overrides` (a list of key.path=value). The information mode is always
/// `acoustic`, because nodes have no other source. Throws UserError.
config::Source ScenarioSource();

/// Throws UserError if `overrides` contradicts the parameter `agents`.
void RequireAgents(int agents);

/// Loads the sections of the run's scenario that Config describes, or the whole scenario. Throws
/// UserError.
template <class Config>
Config LoadScenarioParameters(config::Scope scope = config::Scope::kOwnSections) {
  Config config = config::Load<Config>(ScenarioSource(), scope);
  RequireAgents(config.run.agents);
  return config;
}

/// Warns if `agents` replaces another number in the scenario's file, or if the graph replaces its
/// information mode. Only one node of the graph calls it.
void WarnOfReplacedKeys(int agents);

/// Reads a private parameter of any type. Returns false if it is not set.
bool PrivateParameter(const std::string& name, XmlRpc::XmlRpcValue* value);

/// Throws UserError with the reason if the private parameter is set.
void RefuseParameter(const std::string& name, const std::string& why);

/// Throws UserError if a private parameter is set that this node has not asked for. Called at the
/// end of the start.
void RequireAllParametersRead();

/// A checked parameter. Throws UserError if it has another type, is not finite, or is outside [lo,
/// hi].
double NumberParameter(const std::string& name, double fallback, double lo, double hi,
                       Reach reach = Reach::kNode);
/// The same for whole numbers. The parameter server has 32 bits for them.
int IntegerParameter(const std::string& name, int fallback, int lo, int hi,
                     Reach reach = Reach::kNode);
/// If the parameter is set, throws UserError unless it is one whole number from 0 to `count` - 1,
/// or a list of different ones.
void RequireIndices(const std::string& name, int count);
bool FlagParameter(const std::string& name, bool fallback);
/// A list of texts, or one text with words; empty if the parameter is not set.
std::vector<std::string> TextsParameter(const std::string& name, Reach reach = Reach::kNode);
std::string TextParameter(const std::string& name, const std::string& fallback,
                          Reach reach = Reach::kNode);

/// The parameter /use_sim_time of the graph, even if this node remaps the name.
bool SimulatedTimeParameter();

}  // namespace stg::nodes

#pragma once

#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "auv_common/config/loader.hpp"

namespace stg::nodes {

/// Where a parameter is looked for. Parameters outlive the nodes and launches that they were meant
/// for, so nothing is found by chance on the way between the two places.
enum class Reach {
  kNode,  ///< the node's private namespace alone
  kRun    ///< there, then at the root: one value serves all nodes
};

/// Where the scenario of the run is, from the parameters `scenario` (name or file, default medium),
/// `condition` (default nominal), `agents` (overrides the scenario's, 0: does not) and `overrides`
/// (a list of key.path=value), which are of the whole run. The information mode is always
/// `acoustic`: nodes have no other source. Throws UserError.
config::Source ScenarioSource();

/// Throws UserError when `overrides` contradicts the parameter `agents`.
void RequireAgents(int agents);

/// The sections of the run's scenario that Config describes, or all of the scenario. Throws
/// UserError.
template <class Config>
Config LoadScenarioParameters(config::Scope scope = config::Scope::kOwnSections) {
  Config config = config::Load<Config>(ScenarioSource(), scope);
  RequireAgents(config.run.agents);
  return config;
}

/// Warns when `agents` overrides another number in the scenario's file. For one node of the graph.
void WarnOfOverriddenAgents(int agents);

/// A parameter, checked: throws UserError when it has another type, is not
/// finite, or lies outside [lo, hi].
double NumberParameter(const std::string& name, double fallback, double lo, double hi,
                       Reach reach = Reach::kNode);
/// The same for whole numbers, which the parameter server holds with 32 bits.
int IntegerParameter(const std::string& name, int fallback, int lo, int hi,
                     Reach reach = Reach::kNode);
/// Throws UserError unless a parameter, where it is set, is a list of different whole numbers from
/// 0 to `count` - 1, or one such number.
void RequireIndices(const std::string& name, int count);
bool FlagParameter(const std::string& name, bool fallback);
/// A list of texts, or one text of words; empty when it is not set.
std::vector<std::string> TextsParameter(const std::string& name, Reach reach = Reach::kNode);
std::string TextParameter(const std::string& name, const std::string& fallback,
                          Reach reach = Reach::kNode);

/// The parameter /use_sim_time of the graph, whatever name this node has for it.
bool SimulatedTimeParameter();

}  // namespace stg::nodes

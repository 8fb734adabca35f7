#include "acoustic_channel/fleet/fleet_config.hpp"

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

/// A network of which every key may be left out.
struct PartialNetwork {
  NetworkConfig network;
};

void Describe(PartialNetwork* c, config::Table* t) {
  // Keys of a thing, which is always chosen, need not be stated.
  const auto fleet = [] { return std::vector<std::string>{"fleet"}; };
  t->Thing({"network", fleet(), "channel", fleet}, "", &c->network,
           [](NetworkConfig* network, config::Table* table) { Describe(network, table); });
}

std::optional<config::Violation> FindConflict(const PartialNetwork& c) {
  return FindConflict(c.network);
}

}  // namespace

NetworkConfig LoadFleetNetwork(const std::string& file, const std::vector<std::string>& overrides,
                               int vehicles) {
  // What a default would be is nothing that a fleet at sea could guess.
  if (!config::FindScalar(file, "channel.model")) {
    throw UserError(file + ": channel.model: missing key; it chooses the propagation model");
  }
  const bool scenario = config::FindScalar(file, "name").has_value();
  config::Source source{file, {}, overrides};
  source.overrides.push_back("agents=" + std::to_string(vehicles));
  return config::Load<PartialNetwork>(
             source, scenario ? config::Scope::kOwnSections : config::Scope::kWhole)
      .network;
}

}  // namespace stg::acoustics

#include "acoustic_channel/fleet/fleet_config.hpp"

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

/// A network in which every key may be omitted.
struct PartialNetwork {
  NetworkConfig network;
};

void Describe(PartialNetwork* c, config::Table* t) {
  // The keys of a thing that is always chosen may be omitted.
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
  // For these keys, no default would fit a real fleet.
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

#include "acoustic_channel/fleet/fleet_config.hpp"

#include <algorithm>

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
           [](NetworkConfig* network, config::Table* table) {
             Describe(network, table);
             OwnByScenarios(&network->channel, true, table);
           });
}

std::optional<config::Violation> FindConflict(const PartialNetwork& c) {
  return FindConflict(c.network);
}

/// A file may be a scenario, with the keys of everything else. An override is for the network.
void RequireKeysOfNetwork(const std::vector<std::string>& overrides) {
  PartialNetwork any;
  config::Table table;
  Describe(&any, &table);
  for (const std::string& text : overrides) {
    const std::string key = text.substr(0, text.find('='));
    const bool known = table.Find(key) != nullptr || table.sections().count(key) > 0;
    const auto old = [&](const auto& moved) { return moved.first == key; };
    // The loader refuses a key of an earlier version with the present name.
    if (known || key == "plugins" || std::any_of(table.moved().begin(), table.moved().end(), old)) {
      continue;
    }
    throw UserError("override '" + text + "': the network has no key of this name");
  }
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
  NetworkConfig network =
      config::Load<PartialNetwork>(source,
                                   scenario ? config::Scope::kOwnSections : config::Scope::kWhole)
          .network;
  RequireKeysOfNetwork(overrides);  // now, because the file may have loaded plugins with more keys
  return network;
}

}  // namespace stg::acoustics

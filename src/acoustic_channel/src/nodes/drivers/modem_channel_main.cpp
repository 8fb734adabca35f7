#include "acoustic_channel/driver/modem_channel.hpp"
#include "acoustic_channel/nodes/channel_node.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "modem_parameters.hpp"

namespace stg::nodes {
namespace {

/// Real or emulated modems are in a water of their own, which no scenario describes.
void RefuseWaterOfScenario() {
  for (const std::string& text : TextsParameter("overrides", Reach::kRun)) {
    for (const char* keys :
         {"channel.physical.noise.", "channel.physical.water.", "channel.physical.propagation."}) {
      if (text.rfind(keys, 0) != 0) continue;
      throw UserError("override '" + text +
                      "': the modems have a water of their own; emulated ones read it from their "
                      "configuration (config)");
    }
  }
}

std::unique_ptr<acoustics::Channel> OpenModems(const acoustics::NetworkConfig& scenario) {
  acoustics::ModemChannelConfig modems;
  modems.protocol = TextParameter("protocol", "s2c");
  modems.rssi_offset_db = NumberParameter("rssi_offset_db", -190.0, -1e3, 1e3);
  modems.baud = static_cast<int>(NumberParameter("baud", 19200.0, 1.0, 1e7));
  modems.ports = TextsParameter("ports");
  RefuseUnreadOfModems(modems.protocol, modems.ports);
  RefuseWaterOfScenario();
  return std::make_unique<acoustics::ModemChannel>(scenario.channel, scenario.run, modems);
}

/// The channel of a swarm whose vehicles have their own modems, real or emulated.
class ModemChannelNode : public ChannelNode {
 public:
  ModemChannelNode() : ChannelNode(OpenModems) {}
};

}  // namespace
}  // namespace stg::nodes

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::ModemChannelNode>(argc, argv, "channel",
                                                           stg::nodes::NodeClock::kMessages);
}

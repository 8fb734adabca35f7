#include "acoustic_channel/driver/modem_channel.hpp"
#include "acoustic_channel/nodes/channel_node.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"

namespace stg::nodes {
namespace {

std::unique_ptr<acoustics::Channel> OpenModems(const acoustics::NetworkConfig& scenario) {
  acoustics::ModemChannelConfig modems;
  modems.protocol = TextParameter("protocol", "s2c");
  modems.rssi_offset_db = NumberParameter("rssi_offset_db", -190.0, -1e3, 1e3);
  modems.baud = static_cast<int>(NumberParameter("baud", 19200.0, 1.0, 1e7));
  modems.ports = TextsParameter("ports");
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

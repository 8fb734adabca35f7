#include "acoustic_channel/nodes/channel_node.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_dynamics/terrain/seascape.hpp"
#include "station_reports.hpp"
#include "stg_agent/stations/station_channel.hpp"

namespace stg::nodes {
namespace {

std::unique_ptr<acoustics::Channel> MakeSea(const acoustics::NetworkConfig&,
                                            StationReports* reports) {
  const auto scenario = LoadScenarioParameters<agent::AgentScenario>();
  const dynamics::WorldConfig& world = scenario.world;
  return agent::MakeStationChannel(scenario.model(), scenario.channel, world.sensing,
                                   dynamics::ShadowsOf(world.sea, world.workspace.half_extent_m),
                                   reports);
}

/// An acoustic channel in the scenario's sea: the bottom and obstacles may be between vehicles, and
/// there are beacons and surface craft.
class SeaChannelNode : private StationReports, public ChannelNode {
 public:
  SeaChannelNode()
      : ChannelNode([this](const acoustics::NetworkConfig& c) { return MakeSea(c, this); }) {}
};

}  // namespace
}  // namespace stg::nodes

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::SeaChannelNode>(argc, argv, "channel",
                                                         stg::nodes::NodeClock::kMessages);
}

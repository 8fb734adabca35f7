#include "acoustic_channel/nodes/channel_node.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_dynamics/terrain/seascape.hpp"
#include "auv_dynamics/world/world_config.hpp"

namespace stg::nodes {
namespace {

acoustics::LineOfSight Shadows() {
  const auto scenario = LoadScenarioParameters<dynamics::WorldScenario>();
  return dynamics::ShadowsOf(scenario.world.sea, scenario.world.workspace.half_extent_m);
}

/// The acoustic channel where bottom and obstacles of the scenario's sea stand between vehicles.
class SeaChannelNode : public ChannelNode {
 public:
  SeaChannelNode() : ChannelNode(Shadows()) {}
};

}  // namespace
}  // namespace stg::nodes

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::SeaChannelNode>(argc, argv, "channel",
                                                         stg::nodes::NodeClock::kMessages);
}

#include "acoustic_channel/nodes/channel_node.hpp"
#include "auv_common/nodes/node_main.hpp"

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::ChannelNode>(argc, argv, "channel",
                                                      stg::nodes::NodeClock::kMessages);
}

#include "auv_common/nodes/node_main.hpp"
#include "channel_node.hpp"

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::ChannelNode>(argc, argv, "channel",
                                                      stg::nodes::NodeClock::kMessages);
}

#include "auv_common/nodes/node_main.hpp"
#include "channel_node.hpp"

int main(int argc, char** argv) { return stg::RunNode<stg::ChannelNode>(argc, argv, "channel"); }

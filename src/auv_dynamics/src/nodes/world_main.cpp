#include "auv_common/nodes/node_main.hpp"
#include "world_node.hpp"

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::WorldNode>(argc, argv, "world",
                                                    stg::nodes::NodeClock::kMessages);
}

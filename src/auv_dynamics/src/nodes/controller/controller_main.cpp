#include "auv_common/nodes/node_main.hpp"
#include "controller_node.hpp"

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::ControllerNode>(argc, argv, "controller",
                                                         stg::nodes::NodeClock::kMessages);
}

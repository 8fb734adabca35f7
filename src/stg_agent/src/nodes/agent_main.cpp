#include "agent_node.hpp"
#include "auv_common/nodes/node_main.hpp"

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::AgentNode>(argc, argv, "agent",
                                                    stg::nodes::NodeClock::kMessages);
}

#include "auv_common/nodes/node_main.hpp"
#include "trainer_node.hpp"

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::TrainerNode>(argc, argv, "trainer",
                                                      stg::nodes::NodeClock::kMessages, 0);
}

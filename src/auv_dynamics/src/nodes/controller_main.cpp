#include "auv_common/nodes/node_main.hpp"
#include "controller_node.hpp"

int main(int argc, char** argv) {
  return stg::RunNode<stg::ControllerNode>(argc, argv, "controller");
}

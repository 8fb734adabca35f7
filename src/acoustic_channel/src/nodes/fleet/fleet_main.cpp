#include "auv_common/nodes/node_main.hpp"
#include "fleet_node.hpp"

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::FleetNode>(argc, argv, "acoustic_channel");
}

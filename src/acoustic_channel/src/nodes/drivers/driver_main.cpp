#include "auv_common/nodes/node_main.hpp"
#include "driver_node.hpp"

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::DriverNode>(argc, argv, "modem_driver");
}

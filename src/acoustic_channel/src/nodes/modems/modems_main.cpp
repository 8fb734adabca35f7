#include "auv_common/nodes/node_main.hpp"
#include "modems_node.hpp"

int main(int argc, char** argv) {
  return stg::nodes::RunNode<stg::nodes::ModemsNode>(argc, argv, "acoustic_modems");
}

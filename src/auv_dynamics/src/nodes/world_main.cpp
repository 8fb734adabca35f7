#include "auv_common/nodes/node_main.hpp"
#include "world_node.hpp"

int main(int argc, char** argv) { return stg::RunNode<stg::WorldNode>(argc, argv, "world"); }

#include "auv_common/nodes/node_main.hpp"
#include "metrics_node.hpp"

int main(int argc, char** argv) {
  stg::WatchOnly();
  return stg::RunNode<stg::MetricsNode>(argc, argv, "metrics");
}

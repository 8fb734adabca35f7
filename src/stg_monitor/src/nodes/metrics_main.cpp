#include "auv_common/nodes/node_main.hpp"
#include "metrics_node.hpp"

int main(int argc, char** argv) {
  stg::nodes::WatchOnly();
  return stg::nodes::RunNode<stg::nodes::MetricsNode>(argc, argv, "metrics",
                                                      stg::nodes::NodeClock::kMessages);
}

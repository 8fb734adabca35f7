#include "stg_agent/graph/observation_spec.hpp"

namespace stg::agent {

std::string ObservationSpec::name() const {
  std::string name = "stg-" + std::to_string(kLayoutVersion) + ":raw";
  if (tracking_) name += "+tracking";
  if (semantic_) name += "+semantic";
  if (graph_) {
    name += "+graph";
    if (!links_) name += "-links";
    if (!roles_) name += "-roles";
  }
  return name + (order_ == NeighbourOrder::kNearest ? ":nearest" : ":index");
}

}  // namespace stg::agent

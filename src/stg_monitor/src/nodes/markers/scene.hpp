#pragma once

#include <string>

#include "shapes/swarm_view.hpp"

namespace stg::nodes {

/// What of a resolved scenario is drawn, with defaults for the rest: a bag may be older than this
/// program. Throws YAML::Exception for text that is no scenario at all.
SceneConfig ReadScene(const std::string& yaml);

}  // namespace stg::nodes

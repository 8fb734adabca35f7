#pragma once

#include <string>

#include "shapes/swarm_view.hpp"

namespace stg::nodes {

/// The drawn part of a resolved scenario. Missing keys have defaults, because a bag may be older
/// than this program. Throws YAML::Exception if the text is no scenario.
SceneConfig ReadScene(const std::string& yaml);

}  // namespace stg::nodes

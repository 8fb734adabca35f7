/// Keys of a configuration as dotted paths, such as channel.loss.rate.
#pragma once

#include <string>

namespace stg::config {

/// The section of a key; empty at the top level.
inline std::string Parent(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

/// The last part of the path.
inline std::string Leaf(const std::string& path) { return path.substr(path.rfind('.') + 1); }

}  // namespace stg::config

#pragma once

#include <string>
#include <utility>

#include "auv_common/config/yaml_tree.hpp"

/// What loading and resolving have in common.
namespace stg::config {

/// Files on top of each other.
inline constexpr std::size_t kMaxBases = 8;

/// The map that a text or file holds; UserError when it holds something else.
YamlTree ParseMap(const std::string& text, const std::string& origin);
YamlTree ReadMap(const std::string& path);

/// Path of the file that the entry `base` of file `path` names.
std::string BaseOf(const std::string& path, const YamlTree::Entry& entry);

/// "; did you mean medium.yaml?" where a shipped scenario has nearly that file name, else "".
std::string ShippedHint(const std::string& name);

/// Key and value of `key.path=value`; UserError when there is none.
std::pair<std::string, std::string> SplitOverride(const std::string& text);
/// How messages name an override.
std::string OverrideOrigin(const std::string& text);

}  // namespace stg::config

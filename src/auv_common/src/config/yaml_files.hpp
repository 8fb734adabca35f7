#pragma once

#include <string>
#include <utility>

#include "auv_common/config/yaml_tree.hpp"

/// Functions that loading and resolving have in common.
namespace stg::config {

/// Largest number of files in a chain of bases.
inline constexpr std::size_t kMaxBases = 8;

/// The map in a text or file. Throws UserError if the content is something else.
YamlTree ParseMap(const std::string& text, const std::string& origin);
YamlTree ReadMap(const std::string& path);

/// Path of the file that the entry `base` of the file `path` names.
std::string BaseOf(const std::string& path, const YamlTree::Entry& entry);

/// "; did you mean medium.yaml?" if a shipped scenario has a similar file name, otherwise "".
std::string ShippedHint(const std::string& name);

/// Key and value of `key.path=value`. Throws UserError if there is no key or no value.
std::pair<std::string, std::string> SplitOverride(const std::string& text);
/// Name of an override in messages.
std::string OverrideOrigin(const std::string& text);

}  // namespace stg::config

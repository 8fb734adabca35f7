#pragma once

#include <string>
#include <vector>

#include "auv_common/config/yaml_tree.hpp"

/// Libraries of others, which add things to the registries; auv_common/plugin.hpp is their side.
namespace stg::config {

/// Loads a library, whose things are then in the registries; nothing where it is loaded already. It
/// stays until the program ends. Call this before other threads use a registry. Throws UserError
/// for a file that is missing or no library of this kind, that was built for another version, or
/// that adds a name which is taken.
/// @param library a path; a name without a slash is looked for as the system's loader does
/// @param where begins messages, e.g. "file:line: plugins: "
void LoadPlugin(const std::string& library, const std::string& where);

/// Paths of the loaded libraries, in the order in which they came.
std::vector<std::string> LoadedPlugins();

/// Loads what the key `plugins` of a file's map lists. A relative path counts from the folder of
/// the file; a name without a slash is a file there, or else what the system's loader finds.
void LoadPluginsIn(const YamlTree& map, const std::string& file);

/// Throws UserError unless all that the key `plugins` of a map lists is loaded already. For texts
/// that come from elsewhere, such as in a bag: they must not choose what code runs.
void RequirePluginsOf(const YamlTree& map, const std::string& origin);

/// The line that makes a saved configuration load the same libraries; empty where there are none.
std::string PluginLine();

}  // namespace stg::config

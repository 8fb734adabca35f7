#pragma once

#include <string>
#include <vector>

#include "auv_common/config/yaml_tree.hpp"

/// Shared libraries of other authors that add things to the registries. auv_common/plugin.hpp is
/// for the authors of such libraries.
namespace stg::config {

/// Loads a library, which adds its things to the registries. Does nothing if it is loaded already.
/// The library stays loaded until the program ends. Call this before other threads use a registry.
/// Throws UserError if the file is missing, is not such a library, was built for another version,
/// or adds a name that is taken.
/// @param library a path; the system's loader searches for a name without a slash
/// @param where beginning of messages, e.g. "file:line: plugins: "
void LoadPlugin(const std::string& library, const std::string& where);

/// Paths of the loaded libraries, in the order of loading.
std::vector<std::string> LoadedPlugins();

/// Loads the libraries that the key `plugins` of a file's map lists. A relative path starts at the
/// folder of the file. A name without a slash is a file in that folder; otherwise the system's
/// loader searches for it.
void LoadPluginsIn(const YamlTree& map, const std::string& file);

/// Throws UserError unless all libraries in the key `plugins` of a map are loaded already. This is
/// for texts from other sources, such as a bag: they must not choose which code runs.
void RequirePluginsOf(const YamlTree& map, const std::string& origin);

/// The line that lets a saved configuration load the same libraries; empty if there are none.
std::string PluginLine();

}  // namespace stg::config

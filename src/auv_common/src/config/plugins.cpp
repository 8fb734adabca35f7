#include "auv_common/config/plugins.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <sstream>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_common/plugin.hpp"
#include "yaml_files.hpp"

namespace stg::config {
namespace {

namespace fs = std::filesystem;

/// The loaded libraries. They are never unloaded, because registries refer to their functions.
struct Loaded {
  std::mutex mutex;
  std::vector<std::string> paths;
  std::vector<void*> handles;
};

Loaded& All() {
  static Loaded loaded;
  return loaded;
}

template <class Function>
Function* Find(void* library, const char* name) {
  return reinterpret_cast<Function*>(dlsym(library, name));
}

/// The path at which the system found the library, so that another program finds it, too.
std::string PathOf(const std::string& library, void* function) {
  Dl_info info;
  std::error_code error;
  const bool known = dladdr(function, &info) != 0 && info.dli_fname != nullptr;
  const fs::path path = fs::weakly_canonical(known ? info.dli_fname : library, error);
  return error ? library : path.string();
}

const YamlTree::Entry* ListIn(const YamlTree& map) {
  for (const YamlTree::Entry& entry : map.entries) {
    if (entry.key == "plugins") return &entry;
  }
  return nullptr;
}

void LoadList(const YamlTree& list, const fs::path& folder, const std::string& where) {
  if (list.kind != YamlTree::Kind::kSequence) {
    throw UserError(where + "expected a list of libraries, e.g. [libmine.so]");
  }
  for (const YamlTree& item : list.items) {
    if (item.kind != YamlTree::Kind::kScalar || item.scalar.empty()) {
      throw UserError(where + "expected the name of a library");
    }
    const fs::path name = item.scalar;
    std::error_code error;
    const fs::path beside = folder / name;
    const bool is_path = name.has_parent_path() || fs::exists(beside, error);
    LoadPlugin(is_path ? fs::absolute(beside).string() : name.string(), where);
  }
}

/// Loads the libraries of the bases first. The loader reports wrong names of bases later.
void LoadFile(const std::string& path, std::size_t depth) {
  std::error_code error;
  if (depth > kMaxBases || !fs::is_regular_file(path, error)) return;
  const YamlTree root = ReadMap(path);
  for (const YamlTree::Entry& entry : root.entries) {
    if (entry.key == "base") LoadFile(BaseOf(path, entry), depth + 1);
  }
  LoadPluginsIn(root, path);
}

}  // namespace

void LoadPlugin(const std::string& library, const std::string& where) {
  const std::lock_guard lock(All().mutex);
  // Local, so that equal names in two libraries do not collide.
  void* const handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* reason = dlerror();
    throw UserError(where + (reason == nullptr ? library + ": cannot be loaded" : reason));
  }
  if (std::count(All().handles.begin(), All().handles.end(), handle) > 0) return;
  const auto refuse = [&](const std::string& why) {
    dlclose(handle);
    throw UserError(where + library + ": " + why);
  };
  const auto built_for = Find<const char*()>(handle, "stg_plugin_built_for");
  const auto add = Find<void()>(handle, "stg_plugin_register");
  if (built_for == nullptr || add == nullptr) refuse("is not a plugin: it has no block STG_PLUGIN");
  if (built_for() != BuiltFor()) {
    refuse(std::string("was built for version ") + built_for() + ", this program is version " +
           BuiltFor());
  }
  try {
    add();
  } catch (const std::exception& error) {
    // The things that it has added stay registered, so the library must stay loaded.
    throw UserError(where + library + ": " + error.what());
  }
  All().handles.push_back(handle);
  All().paths.push_back(PathOf(library, reinterpret_cast<void*>(add)));
}

std::vector<std::string> LoadedPlugins() {
  const std::lock_guard lock(All().mutex);
  return All().paths;
}

void LoadPluginsIn(const YamlTree& map, const std::string& file) {
  if (const YamlTree::Entry* entry = ListIn(map)) {
    LoadList(entry->value, fs::path(file).parent_path(),
             file + ":" + std::to_string(entry->line) + ": plugins: ");
  }
}

void RequirePluginsOf(const YamlTree& map, const std::string& origin) {
  const YamlTree::Entry* entry = ListIn(map);
  if (entry == nullptr) return;
  if (const char* trusted = std::getenv("STG_PLUGINS")) {
    std::istringstream names(trusted);
    for (std::string name; std::getline(names, name, ':');) LoadPlugin(name, "STG_PLUGINS: ");
  }
  const std::vector<std::string> loaded = LoadedPlugins();
  for (const YamlTree& item : entry->value.items) {
    if (std::count(loaded.begin(), loaded.end(), item.scalar) > 0) continue;
    throw UserError(origin + ":" + std::to_string(entry->line) + ": plugins: " + item.scalar +
                    ": is not loaded, because received data cannot load libraries; if you trust "
                    "this one, name it in STG_PLUGINS, by --plugin or by stg.load_plugin");
  }
}

void LoadPluginsOf(const Source& source) {
  LoadFile(source.file, 0);
  for (const std::string& overlay : source.overlays) LoadFile(overlay, 0);
  for (const std::string& text : source.overrides) {
    const auto [path, value] = SplitOverride(text);
    if (path != "plugins") continue;
    const std::string where = OverrideOrigin(text) + ": plugins";
    LoadList(ParseYaml(value, where, false), "", where + ": ");
  }
}

std::string PluginLine() {
  std::string text;
  for (const std::string& path : LoadedPlugins()) {
    text += (text.empty() ? "plugins: [\"" : ", \"") + path + '"';
  }
  return text.empty() ? "" : text + "]\n";
}

}  // namespace stg::config

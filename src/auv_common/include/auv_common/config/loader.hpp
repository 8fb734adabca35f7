#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "auv_common/config/field.hpp"
#include "auv_common/config/plugins.hpp"
#include "auv_common/config/value.hpp"
#include "auv_common/config/yaml_tree.hpp"

/// Strict loading of YAML into described structs.
///
/// A file either states every key, or names another file with `base: <file>` (relative to itself)
/// and states the differences. Overlays (files with some of the keys) and `key.path=value`
/// overrides are applied after it, in order. UserError with file, line and key is thrown for an
/// unknown or missing key (except Table::AddOptional), for a wrong type, for a value that is not
/// finite or out of range, and for two overrides of one key.
namespace stg::config {

/// The sources of a configuration.
struct Source {
  std::string file;
  std::vector<std::string> overlays = {};   ///< files
  std::vector<std::string> overrides = {};  ///< key.path=value
};

/// Loads the libraries that the key `plugins` lists in bases, the file, overlays and overrides
/// (`plugins=[libmine.so]`, with paths from the current folder). The keys and names that they add
/// must exist before a table is made. Throws UserError.
void LoadPluginsOf(const Source& source);

/// What a file may contain besides the described keys: nothing, or sections of other programs. A
/// program that needs only some sections of a file leaves the check of the others to the program
/// that knows all of them.
enum class Scope { kWhole, kOwnSections };

/// Fills the fields of one table, and remembers the origin of every value.
class Loader {
 public:
  /// @param table must outlive this object.
  Loader(const Table& table, Scope scope) : table_(table), scope_(scope) {}
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  void Apply(const Source& source);
  /// Loads a whole file that is given as text. `origin` replaces its name in messages. The text
  /// cannot have a base.
  void ApplyText(const std::string& text, const std::string& origin);
  /// Loads the keys of a map that lies at `prefix` ("" or with a point at its end) in `file`. Keys
  /// that are not in the map keep their values. This is for files of other programs that contain a
  /// described section.
  void ApplyPart(const YamlTree& map, const std::string& prefix, const std::string& file);
  /// A list of "key.path=value". Throws UserError if the list has a key twice, because the first
  /// value would have no effect.
  void ApplyOverrides(const std::vector<std::string>& overrides);
  /// Call it after everything was applied. Throws UserError for a key of a thing that was not
  /// chosen, if the key stands in the file that chose another thing, or in a file, overlay or
  /// override on top of it. Keys that a base states for the thing that the base itself chose are
  /// ignored.
  void RefuseUnread() const;
  /// Throws the violation, with the origin of each of its keys.
  [[noreturn]] void Refuse(const Violation& violation) const;

 private:
  using Keys = std::set<std::string>;
  void ApplyOverride(const std::string& text);
  void ApplyFile(const std::string& path);
  void ApplyOverlay(const std::string& path);
  void ApplyBase(const std::string& path, const YamlTree::Entry& entry);
  void ApplyMap(const YamlTree& map, const std::string& prefix, const std::string& file,
                Keys* given);
  void Set(const Field& field, const YamlTree& value, const std::string& where);
  void RequireAll(const YamlTree& root, const std::string& file, const Keys& given) const;
  bool Foreign(const std::string& path) const;
  std::optional<std::string> NewName(const std::string& path) const;
  std::string Nearest(const std::string& path) const;
  std::string Unknown(const std::string& path) const;
  std::string WhereOf(const std::string& key) const;
  int LayerOfChoice(const Owner& owner) const;

  const Table& table_;
  const Scope scope_;
  /// The origin of a value.
  struct Origin {
    std::string where;  ///< "file:line: "
    /// Files count from the last base to the named file. Overlays and overrides share the last
    /// number, because one command asks for all of them.
    int layer = 0;
    bool is_override = false;
  };
  std::map<std::string, Origin> origin_;
  int layer_ = 0;
  std::map<std::string, int> section_lines_;
  std::vector<std::string> open_;  ///< files whose bases are being loaded
};

/// The first field with a value that is not allowed, or nothing.
std::optional<Violation> FindBadValue(const Table& table);

/// Loads a configuration. Config is a struct with Describe(Config*, Table*). For rules between keys
/// it has std::optional<Violation> FindConflict(const Config&). Throws UserError.
template <class Config>
Config Load(const Source& source, Scope scope = Scope::kWhole) {
  LoadPluginsOf(source);
  Config config;
  Table table;
  Describe(&config, &table);
  Loader loader(table, scope);
  loader.Apply(source);
  loader.RefuseUnread();
  if (const auto violation = FindConflict(config)) loader.Refuse(*violation);
  return config;
}

/// What to do with keys of things that were not chosen.
enum class Unread { kRefuse, kPassOver };

/// The same from the text of a whole file. ResolvedText contains all keys of the bases, including
/// those of things that were not chosen in the end, so its text needs kPassOver. The libraries that
/// the text lists must be loaded already.
template <class Config>
Config LoadText(const std::string& text, const std::string& origin,
                Unread unread = Unread::kRefuse) {
  RequirePluginsOf(ParseYaml(text, origin), origin);
  Config config;
  Table table;
  Describe(&config, &table);
  Loader loader(table, Scope::kWhole);
  loader.ApplyText(text, origin);
  if (unread == Unread::kRefuse) loader.RefuseUnread();
  if (const auto violation = FindConflict(config)) loader.Refuse(*violation);
  return config;
}

/// Sets keys of a struct; each override is "key.path=value". Throws UserError as Load does.
template <class Config>
void Override(Config* config, const std::vector<std::string>& overrides) {
  LoadPluginsOf({"", {}, overrides});
  Table table;
  Describe(config, &table);
  Loader loader(table, Scope::kWhole);
  loader.ApplyOverrides(overrides);
  loader.RefuseUnread();
}

/// The first violation of a range or of a rule between keys, or nothing.
template <class Config>
std::optional<Violation> FindViolation(const Config& config) {
  Config copy = config;
  Table table;
  Describe(&copy, &table);
  if (auto violation = FindBadValue(table)) return violation;
  return FindConflict(config);
}

/// Throws UserError if a value is out of range or two keys contradict each other. The message
/// begins with `what` and names the key.
void ThrowViolation(const std::string& what, const Violation& violation);
template <class Config>
void ValidateOrThrow(const Config& config, const std::string& what = "scenario") {
  if (const auto violation = FindViolation(config)) ThrowViolation(what, *violation);
}

/// FNV-1a 64, hexadecimal.
std::string HashOf(const std::string& text);

/// Writes every key that is read, with its value. Optional keys at their fallback that belong to no
/// thing are left out. Loading the result gives the same struct, except for keys that are not read.
/// For a struct, the list of loaded libraries comes first, because its keys may need them.
std::string ToYaml(const Table& table);
template <class Config>
std::string ToYaml(const Config& config) {
  Config copy = config;
  Table table;
  Describe(&copy, &table);
  return PluginLine() + ToYaml(table);
}
/// Hash of the keys only. The paths of the libraries do not count.
template <class Config>
std::string HashOfKeys(const Config& config) {
  Config copy = config;
  Table table;
  Describe(&copy, &table);
  return HashOf(ToYaml(table));
}

/// The source as one file: base, overlays and overrides are merged, and numbers are written as
/// ToYaml writes them. Only the syntax is checked.
std::string ResolvedText(const Source& source);

/// The value of one scalar key in the file, or in the nearest base that states it. It is not
/// checked.
std::optional<std::string> FindScalar(const std::string& file, const std::string& path);

/// Names, without folder and ending, of the file, its base, the base of its base, and so on.
std::vector<std::string> NamesOfBases(const std::string& file);

}  // namespace stg::config

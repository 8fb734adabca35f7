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

/// Strict YAML into described structs.
///
/// A file either states every key or names another one with `base: <file>` (relative to itself)
/// and states the difference; overlays (files with a subset of the keys) and `key.path=value`
/// overrides follow in order. An unknown or missing key (Table::AddOptional apart), a wrong type, a
/// non-finite or out-of-range value throws UserError with file, line and key.
namespace stg::config {

/// Where a configuration comes from.
struct Source {
  std::string file;
  std::vector<std::string> overlays = {};   ///< files
  std::vector<std::string> overrides = {};  ///< key.path=value
};

/// Loads the libraries that the key `plugins` lists, in bases, the file, overlays and overrides
/// (`plugins=[libmine.so]`, paths from the current folder): the keys and names that they add must
/// be there before a table is made. Throws UserError.
void LoadPluginsOf(const Source& source);

/// What a file may hold besides the described keys: nothing, or sections that belong to others. A
/// program that needs some sections of a file leaves the rest to the program that knows them all.
enum class Scope { kWhole, kOwnSections };

/// Fills the fields of one table; every value remembers where it came from.
class Loader {
 public:
  /// @param table must outlive this object.
  Loader(const Table& table, Scope scope) : table_(table), scope_(scope) {}
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  void Apply(const Source& source);
  /// A whole file that is given as text; `origin` stands for its name. It cannot have a base.
  void ApplyText(const std::string& text, const std::string& origin);
  /// Keys of a map that lies at `prefix` ("" or with a point at its end) in `file`; those it leaves
  /// out keep their values. For files of other programs that hold a described section.
  void ApplyPart(const YamlTree& map, const std::string& prefix, const std::string& file);
  /// "key.path=value".
  void ApplyOverride(const std::string& text);
  /// Call after all that was applied. Throws UserError for a key of a thing that was not chosen:
  /// one that stands in the file that chose another, or in one on top of it, an overlay or an
  /// override. What a base states for a thing of its own choice is passed over.
  void RefuseUnread() const;
  /// Throws the violation with the origin of each of its keys.
  [[noreturn]] void Refuse(const Violation& violation) const;

 private:
  using Keys = std::set<std::string>;
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

  const Table& table_;
  const Scope scope_;
  /// Where a value comes from.
  struct Origin {
    std::string where;  ///< "file:line: "
    /// Of the files from the last base to the one that was named; overlays and overrides, which are
    /// asked for together, share the last one.
    int layer = 0;
  };
  std::map<std::string, Origin> origin_;
  int layer_ = 0;
  std::map<std::string, int> section_lines_;
  std::vector<std::string> open_;  ///< files whose bases are being loaded
};

/// First field whose value is not allowed, else nothing.
std::optional<Violation> FindBadValue(const Table& table);

/// Loads a configuration: a struct with Describe(Config*, Table*) and, for rules between keys,
/// std::optional<Violation> FindConflict(const Config&). Throws UserError.
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

/// What happens to keys of things that were not chosen.
enum class Unread { kRefuse, kPassOver };

/// The same from the text of a whole file. ResolvedText merges what bases state for things of their
/// own choice, so that its text needs kPassOver. The libraries that it lists must be loaded
/// already.
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

/// Sets keys of a struct, "key.path=value" each. Throws UserError as Load does.
template <class Config>
void Override(Config* config, const std::vector<std::string>& overrides) {
  LoadPluginsOf({"", {}, overrides});
  Table table;
  Describe(config, &table);
  Loader loader(table, Scope::kWhole);
  for (const std::string& text : overrides) loader.ApplyOverride(text);
  loader.RefuseUnread();
}

/// First violation of a range or of a rule between keys, else nothing.
template <class Config>
std::optional<Violation> FindViolation(const Config& config) {
  Config copy = config;
  Table table;
  Describe(&copy, &table);
  if (auto violation = FindBadValue(table)) return violation;
  return FindConflict(config);
}

/// Throws UserError that begins with `what` and names the key when a value is out of range or two
/// keys contradict each other.
void ThrowViolation(const std::string& what, const Violation& violation);
template <class Config>
void ValidateOrThrow(const Config& config, const std::string& what = "scenario") {
  if (const auto violation = FindViolation(config)) ThrowViolation(what, *violation);
}

/// FNV-1a 64, hexadecimal.
std::string HashOf(const std::string& text);

/// Every key that is read with its value, but optional ones at their fallback that belong to no
/// thing; loading the result gives the same struct, but for what is not read. Of a struct, the
/// libraries that are loaded come first: its keys may need them.
std::string ToYaml(const Table& table);
template <class Config>
std::string ToYaml(const Config& config) {
  Config copy = config;
  Table table;
  Describe(&copy, &table);
  return PluginLine() + ToYaml(table);
}
/// Hash of the keys alone: where libraries lie is no part of what they say.
template <class Config>
std::string HashOfKeys(const Config& config) {
  Config copy = config;
  Table table;
  Describe(&copy, &table);
  return HashOf(ToYaml(table));
}

/// The source as one file: base, overlays and overrides merged, numbers as ToYaml writes them.
/// Checks nothing but the syntax.
std::string ResolvedText(const Source& source);

/// The value of one scalar key in the file or the nearest base that states it, unchecked.
std::optional<std::string> FindScalar(const std::string& file, const std::string& path);

/// Names, without folder and ending, of the file, its base, the base's base and so on.
std::vector<std::string> NamesOfBases(const std::string& file);

}  // namespace stg::config

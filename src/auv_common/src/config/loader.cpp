#include "auv_common/config/loader.hpp"

#include <algorithm>
#include <filesystem>

#include "auv_common/error.hpp"
#include "auv_common/names.hpp"
#include "key_path.hpp"
#include "yaml_files.hpp"

namespace stg::config {
namespace {

namespace fs = std::filesystem;

std::string Where(const std::string& path, int line) {
  return path + ":" + std::to_string(line) + ": ";
}

/// Text of a user without quotes, shortened.
std::string Shortened(const std::string& text) {
  const std::string quoted = Quoted(text);
  return quoted.substr(1, quoted.size() - 2);
}

/// Edit distance between a written text and a key, at most `enough`. The unit of the key may be
/// missing in the text.
std::size_t SlipDistance(const std::string& text, const std::string& key, std::size_t enough) {
  const std::size_t unit = key.rfind('_');
  const std::size_t whole = EditDistance(text, key, enough);
  return unit == std::string::npos ? whole : EditDistance(text, key.substr(0, unit), whole);
}

}  // namespace

void Loader::Apply(const Source& source) {
  ApplyFile(source.file);
  ++layer_;
  for (const std::string& overlay : source.overlays) ApplyOverlay(overlay);
  ApplyOverrides(source.overrides);
}

void Loader::ApplyOverrides(const std::vector<std::string>& overrides) {
  std::map<std::string, std::string> given;
  for (const std::string& text : overrides) {
    const std::string key = SplitOverride(text).first;
    const auto [earlier, first] = given.emplace(key, text);
    if (!first && key != "plugins") {  // each list of plugins has an effect
      throw UserError(OverrideOrigin(text) + ": " + Shortened(key) + ": is also set by " +
                      OverrideOrigin(earlier->second) + "; leave out one of the two");
    }
    ApplyOverride(text);
  }
}

void Loader::ApplyText(const std::string& text, const std::string& origin) {
  const YamlTree root = ParseMap(text, origin);
  for (const auto& entry : root.entries) {
    if (entry.key == "base") throw UserError(Where(origin, entry.line) + "base: not allowed here");
  }
  Keys given;
  ApplyMap(root, "", origin, &given);
  RequireAll(root, origin, given);
}

void Loader::ApplyPart(const YamlTree& map, const std::string& prefix, const std::string& file) {
  Keys given;
  ApplyMap(map, prefix, file, &given);
}

void Loader::Refuse(const Violation& violation) const {
  std::string text = WhereOf(violation.keys[0]) + violation.keys[0] + ": " + violation.message;
  for (std::size_t i = 1; i < violation.keys.size(); ++i) {
    text += "\n  " + WhereOf(violation.keys[i]) + violation.keys[i] + " is " +
            FormatValue(table_.Find(violation.keys[i])->value);
  }
  throw UserError(text);
}

void Loader::ApplyFile(const std::string& path) {
  std::error_code error;  // a path that cannot be resolved fails in ReadMap
  open_.push_back(fs::weakly_canonical(path, error).string());
  const YamlTree root = ReadMap(path);
  Keys given;
  const auto base = std::find_if(root.entries.begin(), root.entries.end(),
                                 [](const auto& entry) { return entry.key == "base"; });
  const bool whole = base == root.entries.end();
  if (!whole) {
    ApplyBase(path, *base);
    ++layer_;
  }
  ApplyMap(root, "", path, &given);
  if (whole) RequireAll(root, path, given);
  open_.pop_back();
}

void Loader::ApplyOverlay(const std::string& path) {
  const YamlTree root = ReadMap(path);
  for (const auto& entry : root.entries) {
    if (entry.key == "base") {
      throw UserError(Where(path, entry.line) + "base: an overlay has no base");
    }
  }
  Keys given;
  ApplyMap(root, "", path, &given);
}

void Loader::ApplyOverride(const std::string& text) {
  const std::string origin = OverrideOrigin(text);
  const auto [path, value] = SplitOverride(text);
  if (path == "plugins") return;
  if (const Field* field = table_.Find(path)) {
    Set(*field, ParseYaml(value, origin + ": " + path, false), origin + ": ");
    origin_[path].is_override = true;
  } else if (!Foreign(path)) {
    throw UserError(origin + ": " + Unknown(path));
  }
}

void Loader::ApplyBase(const std::string& path, const YamlTree::Entry& entry) {
  if (open_.size() >= kMaxBases) {
    throw UserError(Where(path, entry.line) + "base: too many nested base files");
  }
  const std::string base = BaseOf(path, entry);
  std::error_code error;
  const std::string canonical = fs::weakly_canonical(base, error).string();
  if (std::find(open_.begin(), open_.end(), canonical) != open_.end()) {
    throw UserError(Where(path, entry.line) + "base: " + Quoted(entry.value.scalar) +
                    " is based on this file, directly or through others");
  }
  if (error || !fs::is_regular_file(base, error)) {
    throw UserError(Where(path, entry.line) + "base: " + base + " is not a file" +
                    ShippedHint(fs::path(base).filename().string()));
  }
  ApplyFile(base);
}

void Loader::ApplyMap(const YamlTree& map, const std::string& prefix, const std::string& file,
                      Keys* given) {
  for (const YamlTree::Entry& entry : map.entries) {
    const std::string path = prefix + entry.key;
    if (path == "base" || path == "plugins") continue;  // these are read before the keys
    const std::string where = Where(file, entry.line);
    if (const Field* field = table_.Find(path)) {
      Set(*field, entry.value, where);
      given->insert(path);
    } else if (table_.sections().count(path) != 0 &&
               (entry.value.kind == YamlTree::Kind::kMap || !NewName(path))) {
      const bool empty = entry.value.kind == YamlTree::Kind::kNull;
      if (entry.value.kind != YamlTree::Kind::kMap && !empty) {
        throw UserError(where + path + ": expected a map of keys, found " + KindName(entry.value));
      }
      section_lines_[path] = entry.line;
      ApplyMap(entry.value, path + ".", file, given);
    } else if (!Foreign(path)) {
      // If a whole section has moved, the message should name the key, not the section.
      const YamlTree& value = entry.value;
      if (value.kind == YamlTree::Kind::kMap && !value.entries.empty() && NewName(path)) {
        ApplyMap(value, path + ".", file, given);
      }
      throw UserError(where + Unknown(path));
    }
  }
}

void Loader::Set(const Field& field, const YamlTree& value, const std::string& where) {
  if (const auto message = ParseValue(field, value)) {
    throw UserError(where + field.path + ": " + *message);
  }
  origin_[field.path] = {where, layer_};
}

void Loader::RequireAll(const YamlTree& root, const std::string& file, const Keys& given) const {
  std::vector<std::string> missing;
  for (const Field& field : table_.fields()) {
    if (given.count(field.path) != 0 || field.fallback || !field.InFiles()) continue;
    missing.push_back(field.path);
  }
  if (missing.empty()) return;
  int line = root.line;
  const auto section = section_lines_.find(Parent(missing[0]));
  if (section != section_lines_.end()) line = section->second;
  std::string text = Where(file, line) + missing[0] + ": missing key";
  if (missing.size() > 1) text += ", and " + std::to_string(missing.size() - 1) + " more";
  throw UserError(text + " (state every key, or name a base file with 'base: <file>')");
}

/// True for a key at the top level, or in a section there, that this table does not know.
bool Loader::Foreign(const std::string& path) const {
  if (scope_ == Scope::kWhole) return false;
  if (NewName(path)) return false;
  const std::string key = table_.TrueKey(path), top = key.substr(0, key.find('.'));
  return table_.Find(top) == nullptr && table_.sections().count(top) == 0;
}

/// The key or section that was probably meant: the same word in another section, or a similar word
/// in the same section; otherwise "".
std::string Loader::Nearest(const std::string& path) const {
  std::vector<const std::string*> keys;
  for (const Field& field : table_.fields()) keys.push_back(&field.path);
  for (const std::string& section : table_.sections()) keys.push_back(&section);
  const std::string section = Parent(path), leaf = Leaf(path);
  std::string best;
  std::size_t least = std::max<std::size_t>(2, leaf.size() / 3) + 1;
  for (const std::string* key : keys) {
    const std::size_t distance = Parent(*key) == section ? SlipDistance(leaf, Leaf(*key), least)
                                                         : EditDistance(path, *key, least);
    if (distance < least) {
      least = distance;
      best = *key;
    }
  }
  for (const std::string* key : keys) {
    if (best.empty() && Leaf(*key) == leaf) best = *key;
  }
  return best;
}

std::string Loader::Unknown(const std::string& path) const {
  if (const auto name = NewName(path)) return path + ": this key is called " + *name;
  const std::string best = path.size() <= 200 ? Nearest(path) : "";
  const std::string name = Shortened(path), truth = table_.TrueKey(path);
  if (truth != path && table_.Find(truth) != nullptr) {
    return name + ": agents have no value of their own for " + truth;
  }
  const std::string text = name + ": unknown key";
  if (table_.sections().count(path) != 0) return name + ": names a section, not a value";
  return best.empty() ? text : text + ", did you mean " + best + "?";
}

/// The new name of a key of earlier versions, or of a key in a section that has moved.
std::optional<std::string> Loader::NewName(const std::string& path) const {
  for (const auto& [from, to] : table_.moved()) {
    if (path == from) return to;
    if (path.rfind(from + ".", 0) == 0) return to + path.substr(from.size());
  }
  return {};
}

void Loader::RefuseUnread() const {
  for (const Field& field : table_.fields()) {
    const auto set = origin_.find(field.path);
    const Owner* const owner = field.Unchosen();
    if (set == origin_.end() || owner == nullptr) continue;
    if (owner->files_state_all && !set->second.is_override) continue;
    if (set->second.layer < LayerOfChoice(*owner)) continue;
    throw UserError(set->second.where + field.path + ": " + owner->WhyUnread("this configuration"));
  }
}

/// The highest layer that sets a key of the choice.
int Loader::LayerOfChoice(const Owner& owner) const {
  int layer = -1;
  const auto take = [&](const std::string& key) {
    const auto found = origin_.find(key);
    if (found != origin_.end()) layer = std::max(layer, found->second.layer);
  };
  take(owner.key);
  for (const std::string& key : owner.other_keys) take(key);
  return layer;
}

std::string Loader::WhereOf(const std::string& key) const {
  const auto found = origin_.find(key);
  return found == origin_.end() ? "" : found->second.where;
}

std::optional<Violation> FindBadValue(const Table& table) {
  for (const Field& field : table.fields()) {
    if (auto message = CheckValue(field)) return Violation{{field.path}, *message};
  }
  return {};
}

void ThrowViolation(const std::string& what, const Violation& violation) {
  std::string text = what + ": " + violation.keys[0] + ": " + violation.message;
  for (std::size_t i = 1; i < violation.keys.size(); ++i) {
    text += (i == 1 ? " (see " : ", ") + violation.keys[i];
  }
  throw UserError(text + (violation.keys.size() > 1 ? ")" : ""));
}

}  // namespace stg::config

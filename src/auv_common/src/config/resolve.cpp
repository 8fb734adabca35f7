#include <algorithm>
#include <charconv>
#include <filesystem>

#include "auv_common/config/files.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_common/names.hpp"
#include "yaml_files.hpp"

namespace stg::config {
namespace {

YamlTree::Entry* FindEntry(YamlTree* map, const std::string& key) {
  const auto found = std::find_if(map->entries.begin(), map->entries.end(),
                                  [&](const auto& entry) { return entry.key == key; });
  return found == map->entries.end() ? nullptr : &*found;
}

void Merge(const YamlTree& from, YamlTree* into) {
  into->kind = YamlTree::Kind::kMap;
  for (const YamlTree::Entry& entry : from.entries) {
    if (entry.key == "base" || entry.key == "plugins") continue;
    YamlTree::Entry* old = FindEntry(into, entry.key);
    if (old == nullptr) {
      into->entries.push_back(entry);
    } else if (entry.value.kind == YamlTree::Kind::kMap) {
      Merge(entry.value, &old->value);
    } else {
      old->value = entry.value;
    }
  }
}

/// The file merged with its bases.
YamlTree MergedFile(const std::string& path, std::size_t depth = 0) {
  YamlTree root = ReadMap(path);
  YamlTree merged;
  const YamlTree::Entry* base = FindEntry(&root, "base");
  if (base != nullptr) {
    if (depth >= kMaxBases) throw UserError(path + ": too many nested base files");
    merged = MergedFile(BaseOf(path, *base), depth + 1);
  }
  Merge(root, &merged);
  return merged;
}

void SetPath(const std::string& path, const YamlTree& value, YamlTree* root) {
  YamlTree* node = root;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string key = path.substr(begin, end - begin);
    node->kind = YamlTree::Kind::kMap;
    if (FindEntry(node, key) == nullptr) node->entries.push_back({key, 1, YamlTree()});
    node = &FindEntry(node, key)->value;
    begin = end + 1;
  }
  *node = value;
}

std::string FormatScalar(const YamlTree& node) {
  if (node.quoted) return '"' + node.scalar + '"';
  const bool integer = node.scalar.find_first_not_of("-0123456789") == std::string::npos;
  double number = 0.0;
  const char* end = node.scalar.data() + node.scalar.size();
  const auto read = std::from_chars(node.scalar.data(), end, number);
  if (integer || read.ec != std::errc() || read.ptr != end) return node.scalar;
  return FormatValue(&number);
}

std::string FormatInline(const YamlTree& node) {
  if (node.kind != YamlTree::Kind::kSequence) return FormatScalar(node);
  std::string text = "[";
  for (const YamlTree& item : node.items) {
    text += (text.size() > 1 ? ", " : "") + FormatInline(item);
  }
  return text + "]";
}

void Write(const YamlTree& map, const std::string& indent, std::string* text) {
  for (const YamlTree::Entry& entry : map.entries) {
    *text += indent + entry.key + ":";
    if (entry.value.kind == YamlTree::Kind::kMap) {
      *text += "\n";
      Write(entry.value, indent + "  ", text);
    } else {
      *text += " " + FormatInline(entry.value) + "\n";
    }
  }
}

}  // namespace

std::string ResolvedText(const Source& source) {
  LoadPluginsOf(source);
  YamlTree root = MergedFile(source.file);
  for (const std::string& overlay : source.overlays) Merge(ReadMap(overlay), &root);
  for (const std::string& text : source.overrides) {
    const auto [path, value] = SplitOverride(text);
    if (path == "plugins") continue;
    SetPath(path, ParseYaml(value, OverrideOrigin(text) + ": " + path, false), &root);
  }
  std::string text = PluginLine();
  Write(root, "", &text);
  return text;
}

std::optional<std::string> FindScalar(const std::string& file, const std::string& path) {
  const YamlTree root = MergedFile(file);
  const YamlTree* node = &root;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string key = path.substr(begin, end - begin);
    const auto found = std::find_if(node->entries.begin(), node->entries.end(),
                                    [&](const auto& entry) { return entry.key == key; });
    if (found == node->entries.end()) return {};
    node = &found->value;
    begin = end + 1;
  }
  if (node->kind != YamlTree::Kind::kScalar) return {};
  return node->scalar;
}

std::vector<std::string> NamesOfBases(const std::string& file) {
  namespace fs = std::filesystem;
  std::vector<std::string> names;
  std::string path = file;
  while (names.size() <= kMaxBases) {
    names.push_back(fs::path(path).stem().string());
    const YamlTree root = ReadMap(path);
    const auto base = std::find_if(root.entries.begin(), root.entries.end(),
                                   [](const auto& entry) { return entry.key == "base"; });
    if (base == root.entries.end()) break;
    path = BaseOf(path, *base);
  }
  return names;
}

YamlTree ParseMap(const std::string& text, const std::string& origin) {
  YamlTree root = ParseYaml(text, origin);
  if (root.kind == YamlTree::Kind::kNull) throw UserError(origin + ":1: the file is empty");
  if (root.kind != YamlTree::Kind::kMap) {
    throw UserError(origin + ":" + std::to_string(root.line) + ": expected a map of keys, found " +
                    KindName(root));
  }
  return root;
}

YamlTree ReadMap(const std::string& path) { return ParseMap(ReadBoundedFile(path), path); }

std::string BaseOf(const std::string& path, const YamlTree::Entry& entry) {
  if (entry.value.kind != YamlTree::Kind::kScalar || entry.value.scalar.empty()) {
    throw UserError(path + ":" + std::to_string(entry.line) +
                    ": base: expected a file name, found " + KindName(entry.value));
  }
  namespace fs = std::filesystem;
  const fs::path name = entry.value.scalar;
  const fs::path beside = fs::path(path).parent_path() / name;
  std::error_code error;
  if (name.has_parent_path() || fs::exists(beside, error)) return beside.string();
  try {
    const fs::path shipped = fs::path(ScenarioFolder()) / name;
    if (fs::is_regular_file(shipped, error)) return shipped.string();
  } catch (const UserError&) {
    // There are no shipped files, so the message names the missing file in the same folder.
  }
  return beside.string();
}

std::string ShippedHint(const std::string& name) {
  namespace fs = std::filesystem;
  std::vector<std::string> shipped;
  try {
    std::error_code error;
    for (fs::directory_iterator it(ScenarioFolder(), error), end; !error && it != end;
         it.increment(error)) {
      shipped.push_back(it->path().filename().string());
    }
  } catch (const UserError&) {
    return "";  // there are no shipped files
  }
  std::sort(shipped.begin(), shipped.end());
  const std::string nearest = NearestName(name, shipped);
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

std::string OverrideOrigin(const std::string& text) { return "--set " + Quoted(text); }

std::pair<std::string, std::string> SplitOverride(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw UserError(OverrideOrigin(text) + ": expected key.path=value");
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

}  // namespace stg::config

#include "auv_dynamics/scenario_yaml.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <set>

#include "auv_dynamics/error.hpp"
#include "scenario_schema.hpp"
#include "scenario_value.hpp"
#include "yaml_tree.hpp"

namespace stg {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBases = 8;

std::size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

std::string Parent(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}
std::string Leaf(const std::string& path) { return path.substr(path.rfind('.') + 1); }

/// Builds one scenario; every value remembers where it came from.
class Loader {
 public:
  Loader() : fields_(ScenarioFields(&scenario_)) {
    for (ScenarioField& field : fields_) {
      index_[field.path] = &field;
      for (std::string p = Parent(field.path); !p.empty(); p = Parent(p)) sections_.insert(p);
    }
  }
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  void ApplyScenario(const std::string& path) {
    std::error_code error;  // a path that cannot be resolved fails in ReadMap
    open_.push_back(fs::weakly_canonical(path, error).string());
    const YamlTree root = ReadMap(path);
    std::set<std::string> given;
    const auto base = std::find_if(root.entries.begin(), root.entries.end(),
                                   [](const auto& entry) { return entry.key == "base"; });
    const bool whole = base == root.entries.end();
    if (!whole) ApplyBase(path, *base);
    ApplyMap(root, "", path, &given);
    if (whole) RequireAll(root, path, given);
    open_.pop_back();
  }

  void ApplyOverlay(const std::string& path) {
    const YamlTree root = ReadMap(path);
    for (const auto& entry : root.entries) {
      if (entry.key == "base") {
        throw UserError(Where(path, entry.line) + "base: an overlay has no base");
      }
    }
    std::set<std::string> given;
    ApplyMap(root, "", path, &given);
  }

  void ApplyOverride(const std::string& text) {
    const std::string origin = "--set " + Quoted(text);
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw UserError(origin + ": expected key.path=value");
    }
    const std::string path = text.substr(0, equals);
    const auto found = index_.find(path);
    if (found == index_.end()) throw UserError(origin + ": " + Unknown(path));
    const YamlTree value = ParseYaml(text.substr(equals + 1), origin + ": " + path, false);
    Set(*found->second, value, origin + ": ");
  }

  /// The finished scenario, checked as a whole.
  Scenario Finish() const {
    const auto violation = FindViolation(scenario_);
    if (!violation) return scenario_;
    std::string text = Origin(violation->keys[0]) + violation->keys[0] + ": " + violation->message;
    for (std::size_t i = 1; i < violation->keys.size(); ++i) {
      text += "\n  " + Origin(violation->keys[i]) + violation->keys[i] + " is " +
              FormatValue(index_.at(violation->keys[i])->value);
    }
    throw UserError(text);
  }

 private:
  static std::string Where(const std::string& path, int line) {
    return path + ":" + std::to_string(line) + ": ";
  }

  static YamlTree ReadMap(const std::string& path) {
    YamlTree root = ParseYaml(ReadBoundedFile(path), path);
    if (root.kind == YamlTree::Kind::kNull) throw UserError(path + ":1: the file is empty");
    if (root.kind != YamlTree::Kind::kMap) {
      throw UserError(Where(path, root.line) + "expected a map of keys, found " + KindName(root));
    }
    return root;
  }

  void ApplyBase(const std::string& path, const YamlTree::Entry& entry) {
    const std::string where = Where(path, entry.line) + "base: ";
    if (entry.value.kind != YamlTree::Kind::kScalar || entry.value.scalar.empty()) {
      throw UserError(where + "expected a file name, found " + KindName(entry.value));
    }
    if (open_.size() >= kMaxBases) throw UserError(where + "too many bases on top of each other");
    const fs::path base = fs::path(path).parent_path() / entry.value.scalar;
    std::error_code error;
    const std::string canonical = fs::weakly_canonical(base, error).string();
    if (std::find(open_.begin(), open_.end(), canonical) != open_.end()) {
      throw UserError(where + Quoted(entry.value.scalar) + " leads back to itself");
    }
    if (error || !fs::is_regular_file(base, error)) {
      throw UserError(where + base.string() + " is not a file");
    }
    ApplyScenario(base.string());
  }

  void ApplyMap(const YamlTree& map, const std::string& prefix, const std::string& file,
                std::set<std::string>* given) {
    for (const YamlTree::Entry& entry : map.entries) {
      const std::string path = prefix + entry.key;
      if (path == "base") continue;
      const std::string where = Where(file, entry.line);
      const auto found = index_.find(path);
      if (found != index_.end()) {
        Set(*found->second, entry.value, where);
        given->insert(path);
      } else if (sections_.count(path) != 0) {
        const bool empty = entry.value.kind == YamlTree::Kind::kNull;
        if (entry.value.kind != YamlTree::Kind::kMap && !empty) {
          throw UserError(where + path + ": expected a map of keys, found " +
                          KindName(entry.value));
        }
        section_lines_[path] = entry.line;
        ApplyMap(entry.value, path + ".", file, given);
      } else {
        throw UserError(where + Unknown(path));
      }
    }
  }

  void Set(const ScenarioField& field, const YamlTree& value, const std::string& where) {
    if (const auto message = ParseValue(field, value)) {
      throw UserError(where + field.path + ": " + *message);
    }
    origin_[field.path] = where;
  }

  void RequireAll(const YamlTree& root, const std::string& file,
                  const std::set<std::string>& given) const {
    std::vector<std::string> missing;
    for (const ScenarioField& field : fields_) {
      if (given.count(field.path) == 0) missing.push_back(field.path);
    }
    if (missing.empty()) return;
    int line = root.line;
    const auto section = section_lines_.find(Parent(missing[0]));
    if (section != section_lines_.end()) line = section->second;
    std::string text = Where(file, line) + missing[0] + ": missing key";
    if (missing.size() > 1) text += ", and " + std::to_string(missing.size() - 1) + " more";
    throw UserError(text + " (state every key, or name a base file with 'base: <file>')");
  }

  /// The key this was probably meant to be: the same word elsewhere, or a
  /// similar word in the same section.
  std::string Unknown(const std::string& path) const {
    std::set<std::string> keys = sections_;
    for (const auto& item : index_) keys.insert(item.first);
    std::string best;
    if (path.size() <= 200) {
      std::size_t least = std::max<std::size_t>(2, Leaf(path).size() / 3) + 1;
      for (const std::string& key : keys) {
        const std::size_t distance = Parent(key) == Parent(path)
                                         ? EditDistance(Leaf(path), Leaf(key))
                                         : EditDistance(path, key);
        if (distance < least) {
          least = distance;
          best = key;
        }
      }
      for (const std::string& key : keys) {
        if (best.empty() && Leaf(key) == Leaf(path)) best = key;
      }
    }
    std::string name = Quoted(path);
    name = name.substr(1, name.size() - 2);
    std::string text = name + ": unknown key";
    if (sections_.count(path) != 0) return name + ": names a section, not a value";
    return best.empty() ? text : text + ", did you mean " + best + "?";
  }

  std::string Origin(const std::string& key) const {
    const auto found = origin_.find(key);
    return found == origin_.end() ? "" : found->second;
  }

  Scenario scenario_;
  std::vector<ScenarioField> fields_;
  std::map<std::string, const ScenarioField*> index_;
  std::set<std::string> sections_;
  std::map<std::string, std::string> origin_;  ///< key to "file:line: "
  std::map<std::string, int> section_lines_;
  std::vector<std::string> open_;  ///< files whose bases are being loaded
};

}  // namespace

Scenario LoadScenario(const std::string& file, const std::vector<std::string>& overlays,
                      const std::vector<std::string>& overrides) {
  Loader loader;
  loader.ApplyScenario(file);
  for (const std::string& overlay : overlays) loader.ApplyOverlay(overlay);
  for (const std::string& text : overrides) loader.ApplyOverride(text);
  return loader.Finish();
}

std::string ToYaml(const Scenario& scenario) {
  Scenario copy = scenario;
  std::string text;
  std::string open;  // section whose heading was written last
  for (const ScenarioField& field : ScenarioFields(&copy)) {
    const std::string section = Parent(field.path);
    const auto indent = [](const std::string& path) {
      return std::string(static_cast<std::size_t>(2 * std::count(path.begin(), path.end(), '.')),
                         ' ');
    };
    // Headings of the levels that are new against the previous key.
    for (std::size_t end = 0; end < section.size();) {
      end = std::min(section.find('.', end + 1), section.size());
      const std::string level = section.substr(0, end);
      if (open != level && open.rfind(level + ".", 0) != 0) {
        text += indent(level) + Leaf(level) + ":\n";
      }
    }
    open = section;
    text += indent(field.path) + Leaf(field.path) + ": " + FormatValue(field.value) + "\n";
  }
  return text;
}

std::string ScenarioHash(const Scenario& scenario) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : ToYaml(scenario)) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  }
  char buffer[17];
  const auto result = std::to_chars(buffer, buffer + 16, hash, 16);
  const std::string digits(buffer, result.ptr);
  return std::string(16 - digits.size(), '0') + digits;
}

}  // namespace stg

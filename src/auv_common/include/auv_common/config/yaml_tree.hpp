#pragma once

#include <string>
#include <utility>
#include <vector>

/// A YAML document as plain data with line numbers. It has only the parts that a configuration file
/// needs: maps, sequences and scalars. Anchors, aliases and tags are refused. Depth and node count
/// are bounded, so that a small file cannot take much time or memory.
namespace stg::config {

struct YamlTree {
  enum class Kind { kNull, kScalar, kSequence, kMap };
  struct Entry;

  Kind kind = Kind::kNull;
  int line = 1;         ///< 1-based line where the node starts
  bool quoted = false;  ///< scalar in quotes: text, never a number
  std::string scalar;
  std::vector<YamlTree> items;  ///< elements of a sequence
  std::vector<Entry> entries;   ///< entries of a map, in file order, with distinct keys
};

struct YamlTree::Entry {
  std::string key;
  int line = 1;  ///< line of the key
  YamlTree value;
};

/// Largest total number of maps, sequences and scalars in a scenario.
inline constexpr int kMaxValues = 20000;

/// Parses one document of at most `max_values` values. An empty text gives a null node. Throws
/// UserError; its message starts with `origin`, followed by `:line` when `with_lines`.
YamlTree ParseYaml(const std::string& text, const std::string& origin, bool with_lines = true,
                   int max_values = kMaxValues);

/// The content of a regular file of at most 1 MiB. Throws UserError for any other file.
std::string ReadBoundedFile(const std::string& path);

/// Text of a user for a message: in quotes, shortened, and with control characters replaced.
std::string Quoted(const std::string& text);

}  // namespace stg::config

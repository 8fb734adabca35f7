#pragma once

#include <string>
#include <utility>
#include <vector>

/// A YAML document as plain data with line numbers. Only what a configuration
/// file needs: maps, sequences and scalars. Anchors, aliases and tags are
/// refused, and depth and node count are bounded, so that no input can make a
/// small file expensive.
namespace stg::config {

struct YamlTree {
  enum class Kind { kNull, kScalar, kSequence, kMap };
  struct Entry;

  Kind kind = Kind::kNull;
  int line = 1;         ///< 1-based line where the node starts
  bool quoted = false;  ///< scalar in quotes: a string, never a number
  std::string scalar;
  std::vector<YamlTree> items;  ///< of a sequence
  std::vector<Entry> entries;   ///< of a map, in file order, keys distinct
};

struct YamlTree::Entry {
  std::string key;
  int line = 1;  ///< line of the key
  YamlTree value;
};

/// Maps, sequences and scalars that a scenario may have, together.
inline constexpr int kMaxValues = 20000;

/// Parses one document of at most so many values. An empty text gives a null node. Throws UserError
/// whose message starts with `origin`, followed by `:line` when `with_lines`.
YamlTree ParseYaml(const std::string& text, const std::string& origin, bool with_lines = true,
                   int max_values = kMaxValues);

/// The whole of a regular file of at most 1 MiB; throws UserError otherwise.
std::string ReadBoundedFile(const std::string& path);

/// User text for a message: in quotes, shortened, control characters replaced.
std::string Quoted(const std::string& text);

}  // namespace stg::config

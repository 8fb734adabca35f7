#pragma once

#include <optional>
#include <string>

#include "auv_common/config/field.hpp"
#include "auv_common/config/yaml_tree.hpp"

/// Values of single keys as text: reading, writing and checking.
namespace stg::config {

/// Kind of a node, for messages "expected ..., found ...".
std::string KindName(const YamlTree& node);

/// Reads the node into the member that the field points to. Returns a message if the type or the
/// range does not fit, otherwise nothing. Numbers are strict: no other text, no quotes, no NaN or
/// infinity, and integers without a point.
std::optional<std::string> ParseValue(const Field& field, const YamlTree& node);

/// The same for the text of a command line. A TextRef takes the text unchanged, and a list needs no
/// brackets. Throws UserError for a text that is not YAML.
std::optional<std::string> ParseText(const Field& field, const std::string& text);

/// The shortest text that reads back as the same double. It always has a point, so every YAML
/// reader takes it for a real number.
std::string FormatNumber(double value);

/// The value as a YAML scalar or flow sequence. Numbers read back exactly.
std::string FormatValue(const ValueRef& value);

/// Allowed values in words: "(0, 10]", "truth | acoustic", "true | false".
std::string FormatRange(const Field& field);

/// A message if the value itself is not allowed, otherwise nothing.
std::optional<std::string> CheckValue(const Field& field);

/// A model's value of a key, as text; empty: it has the key's own value.
std::string TextOf(const DifferenceRef& difference);
/// A message if the key does not take the value, otherwise nothing. The key's own value stays.
std::optional<std::string> ParseDifference(const DifferenceRef& difference, const YamlTree& node);
std::optional<std::string> CheckDifference(const DifferenceRef& difference);
/// Sets the keys of the table to the model's values, and ignores keys that the table does not have.
/// Throws UserError for a value that its key does not take.
void Apply(const Differences& differences, const Table& table);

}  // namespace stg::config

#pragma once

#include <optional>
#include <string>

#include "auv_common/config/field.hpp"
#include "auv_common/config/yaml_tree.hpp"

/// Values of single keys as text: read, write, check.
namespace stg::config {

/// What a node is, for "expected ..., found ..." messages.
std::string KindName(const YamlTree& node);

/// Reads the node into the member that the field points to. Message when type
/// or range do not fit, else nothing. Numbers are strict: no surrounding text,
/// no quotes, no NaN or infinity, integers without a point.
std::optional<std::string> ParseValue(const Field& field, const YamlTree& node);

/// The same from the text of a command line: a TextRef takes it as it is, a list needs no brackets.
/// Throws UserError for a text that is no YAML.
std::optional<std::string> ParseText(const Field& field, const std::string& text);

/// Shortest text that reads back as the same double, always with a point so that every YAML reader
/// takes it for a real number.
std::string FormatNumber(double value);

/// The value as a YAML scalar or flow sequence; numbers round-trip exactly.
std::string FormatValue(const ValueRef& value);

/// Allowed values in words: "(0, 10]", "truth | acoustic", "true | false".
std::string FormatRange(const Field& field);

/// Message when the value itself is not allowed, else nothing.
std::optional<std::string> CheckValue(const Field& field);

/// The value that a model has for a key, as text; empty: that of the key.
std::string TextOf(const DifferenceRef& difference);
/// Message when the key does not take the value, else nothing. The key keeps its own.
std::optional<std::string> ParseDifference(const DifferenceRef& difference, const YamlTree& node);
std::optional<std::string> CheckDifference(const DifferenceRef& difference);
/// Sets the keys of the table to the values that a model has for them; passes over keys that the
/// table lacks. Throws UserError for a value that its key does not take.
void Apply(const Differences& differences, const Table& table);

}  // namespace stg::config

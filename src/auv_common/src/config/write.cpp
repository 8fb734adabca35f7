#include <algorithm>
#include <charconv>

#include "auv_common/config/loader.hpp"
#include "auv_common/config/value.hpp"
#include "key_path.hpp"

namespace stg::config {
namespace {

std::string FormatNumbers(const double* values, int size) {
  std::string text = "[";
  for (int i = 0; i < size; ++i) text += (i > 0 ? ", " : "") + FormatNumber(values[i]);
  return text + "]";
}

/// Quotes words that some YAML readers do not take as text.
std::string FormatWord(const std::string& word) {
  for (const char* special : {"on", "off", "yes", "no", "true", "false", "null", "y", "n"}) {
    if (word == special) return "\"" + word + "\"";
  }
  return word;
}

std::string FormatText(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
  return quoted + "\"";
}

std::string FormatWords(const std::vector<std::string>& words) {
  std::string text = "[";
  for (std::size_t i = 0; i < words.size(); ++i) text += (i > 0 ? ", " : "") + FormatWord(words[i]);
  return text + "]";
}

}  // namespace

std::string FormatNumber(double value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  std::string text(buffer, result.ptr);
  if (text.find_first_of(".n") == std::string::npos) {
    const auto exponent = text.find('e');
    text.insert(exponent == std::string::npos ? text.size() : exponent, ".0");
  }
  return text;
}

std::string FormatValue(const ValueRef& value) {
  return std::visit(Overload{[](double* v) { return FormatNumber(*v); },
                             [](int* v) { return std::to_string(*v); },
                             [](std::int64_t* v) { return std::to_string(*v); },
                             [](std::uint64_t* v) { return std::to_string(*v); },
                             [](bool* v) { return std::string(*v ? "true" : "false"); },
                             [](std::string* v) { return FormatWord(*v); },
                             [](const EnumRef& v) {
                               const auto index = static_cast<std::size_t>(v.get());
                               return index < v.names.size() ? FormatWord(v.names[index])
                                                             : std::string("?");
                             },
                             [](const NumbersRef& v) { return FormatNumbers(v.data, v.size); },
                             [](Interval* v) {
                               const double ends[] = {v->lo, v->hi};
                               return FormatNumbers(ends, 2);
                             },
                             [](const WholeNumbersRef& v) {
                               std::string text;
                               for (const int x : *v.list) {
                                 text += (text.empty() ? "" : ", ") + std::to_string(x);
                               }
                               return "[" + text + "]";
                             },
                             [](const RowsRef& v) {
                               std::string text;
                               for (const auto& row : *v.rows) {
                                 text += (text.empty() ? "" : ", ") +
                                         FormatNumbers(row.data(), static_cast<int>(row.size()));
                               }
                               return "[" + text + "]";
                             },
                             [](const NamesRef& v) { return FormatWords(*v.list); },
                             [](const NameOrFileRef& v) { return FormatWord(*v.text); },
                             [](const TextRef& v) { return FormatText(*v.text); },
                             [](const DifferenceRef& v) { return TextOf(v); }},
                    value);
}

std::string ToYaml(const Table& table) {
  std::string text;
  std::string open;  // section of the last heading
  for (const Field& field : table.fields()) {
    if (!field.InFiles()) continue;
    const bool whole = field.owners.empty() || std::holds_alternative<DifferenceRef>(field.value);
    if (whole && field.fallback && FormatValue(field.value) == *field.fallback) continue;
    const std::string section = Parent(field.path);
    const auto indent = [](const std::string& path) {
      return std::string(static_cast<std::size_t>(2 * std::count(path.begin(), path.end(), '.')),
                         ' ');
    };
    // Headings of the levels that differ from the previous key.
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

std::string HashOf(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  }
  char buffer[17];
  const auto result = std::to_chars(buffer, buffer + 16, hash, 16);
  const std::string digits(buffer, result.ptr);
  return std::string(16 - digits.size(), '0') + digits;
}

}  // namespace stg::config

#include <algorithm>
#include <charconv>

#include "auv_common/config/loader.hpp"
#include "key_path.hpp"

namespace stg::config {

std::string ToYaml(const Table& table) {
  std::string text;
  std::string open;  // section whose heading was written last
  for (const Field& field : table.fields()) {
    if (field.Unchosen() != nullptr) continue;
    const bool whole = field.owners.empty() || std::holds_alternative<DifferenceRef>(field.value);
    if (whole && field.fallback && FormatValue(field.value) == *field.fallback) continue;
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

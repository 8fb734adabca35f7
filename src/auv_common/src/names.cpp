#include "auv_common/names.hpp"

#include <algorithm>

#include "auv_common/config/yaml_tree.hpp"

namespace stg {

bool IsName(const std::string& text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (text.empty() || text.size() > 64 || !letter(text[0])) return false;
  for (const char c : text) {
    if (!letter(c) && !(c >= '0' && c <= '9') && c != '_' && c != '-') return false;
  }
  return true;
}

bool IsText(const std::string& text) {
  const auto byte = [&text](std::size_t i) -> unsigned {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned first = byte(i++);
    if (first < 0x80) {
      if (first < 0x20 || first == 0x7f) return false;
      continue;
    }
    // Unicode, table 3-7: lead bytes, and the bytes that may follow them.
    const int more = first >= 0xc2 && first <= 0xdf   ? 1
                     : first >= 0xe0 && first <= 0xef ? 2
                     : first >= 0xf0 && first <= 0xf4 ? 3
                                                      : 0;
    if (more == 0) return false;
    const unsigned low = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
    const unsigned high = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
    if (byte(i) < low || byte(i) > high) return false;
    for (int k = 1; k < more; ++k) {
      if ((byte(i + static_cast<std::size_t>(k)) & 0xc0U) != 0x80U) return false;
    }
    i += static_cast<std::size_t>(more);
  }
  return true;
}

std::size_t EditDistance(const std::string& a, const std::string& b, std::size_t enough) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) >= enough) return enough;
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    std::size_t least = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
      least = std::min(least, row[j]);
    }
    if (least >= enough) return enough;  // the values of later rows are not smaller
  }
  return std::min(row[b.size()], enough);
}

std::string NearestName(const std::string& text, const std::vector<std::string>& names) {
  constexpr std::size_t kLongest = 200;  // a longer text is no typing error
  if (text.size() > kLongest) return "";
  std::string best;
  std::size_t least = std::max<std::size_t>(2, text.size() / 3) + 1;
  for (const std::string& name : names) {
    const std::size_t distance = EditDistance(text, name, least);
    if (distance < least) {
      least = distance;
      best = name;
    }
  }
  return best;
}

std::string JoinNames(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " | ") + name;
  return text;
}

std::vector<std::string> Without(std::vector<std::string> names,
                                 const std::vector<std::string>& others) {
  const auto is_other = [&others](const std::string& name) {
    return std::find(others.begin(), others.end(), name) != others.end();
  };
  names.erase(std::remove_if(names.begin(), names.end(), is_other), names.end());
  return names;
}

UserError UnknownName(const std::string& kind, const std::string& name,
                      const std::vector<std::string>& names) {
  std::string text =
      "unknown " + kind + " " + config::Quoted(name) + ", expected one of " + JoinNames(names);
  const std::string nearest = NearestName(name, names);
  if (!nearest.empty()) text += "; did you mean " + nearest + "?";
  return UserError(text);
}

}  // namespace stg

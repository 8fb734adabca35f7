#include "auv_common/config/value.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>
#include <utility>

#include "auv_common/names.hpp"

namespace stg::config {
namespace {

constexpr char kNameRule[] = "a letter, then letters, digits, _ or -";

bool IsFile(const std::string& text, const std::string& extension) {
  constexpr std::size_t kLongest = 1024;
  const std::size_t stem = text.size() - std::min(text.size(), extension.size());
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.' || c == '/' || c == '+';
  };
  return stem > 0 && text.size() <= kLongest && text.compare(stem, text.npos, extension) == 0 &&
         text[0] != '-' && std::all_of(text.begin(), text.end(), plain);
}

/// Writes bounds in a short form.
std::string FormatBound(double value) {
  char buffer[32];
  const auto result =
      std::to_chars(buffer, buffer + sizeof(buffer), value, std::chars_format::general);
  return {buffer, result.ptr};
}

std::optional<std::string> CheckNumbers(const Field& field, const double* values, int size) {
  for (int i = 0; i < size; ++i) {
    if (!std::isfinite(values[i])) return "must be finite";
    if (!field.limits.Contain(values[i])) {
      return FormatNumber(values[i]) + " is out of range " + FormatRange(field);
    }
  }
  return {};
}

std::optional<std::string> CheckWhole(const Field& field, std::int64_t value) {
  if (field.limits.Contain(static_cast<double>(value))) return {};
  return std::to_string(value) + " is out of range " + FormatRange(field);
}

/// Message for a refused value. The caller adds file, line and key.
struct Refusal {
  std::string message;
};

double ToDouble(const YamlTree& node) {
  const std::string& s = node.scalar;
  if (node.kind != YamlTree::Kind::kScalar || node.quoted) {
    throw Refusal{"expected a number, found " + KindName(node)};
  }
  double value = 0.0;
  const auto result = std::from_chars(s.data(), s.data() + s.size(), value);
  const bool special = s.find("inf") != std::string::npos || s.find("nan") != std::string::npos ||
                       s.find("Inf") != std::string::npos || s.find("NaN") != std::string::npos ||
                       s.find("INF") != std::string::npos || s.find("NAN") != std::string::npos;
  if (special && s.size() <= 5) throw Refusal{"must be a finite number, found " + KindName(node)};
  if (result.ec == std::errc::result_out_of_range) {
    throw Refusal{"the number is too large or too small: " + KindName(node)};
  }
  if (result.ec != std::errc() || result.ptr != s.data() + s.size() || !std::isfinite(value)) {
    throw Refusal{"expected a number, found " + KindName(node)};
  }
  return value;
}

template <class Int>
Int ToInteger(const YamlTree& node) {
  const std::string& s = node.scalar;
  if (node.kind != YamlTree::Kind::kScalar || node.quoted) {
    throw Refusal{"expected an integer, found " + KindName(node)};
  }
  Int value = 0;
  const auto result = std::from_chars(s.data(), s.data() + s.size(), value);
  const bool digits = !s.empty() &&
                      s.find_first_not_of("0123456789", s[0] == '-' ? 1 : 0) == std::string::npos &&
                      s != "-";
  if (digits && s[0] == '-' && std::is_unsigned_v<Int>) {
    throw Refusal{KindName(node) + " is out of range: expected a whole number from 0"};
  }
  if (digits && (result.ec != std::errc() || result.ptr != s.data() + s.size())) {
    throw Refusal{KindName(node) + " is out of range"};
  }
  if (!digits) throw Refusal{"expected an integer, found " + KindName(node)};
  return value;
}

std::vector<double> ToDoubles(const YamlTree& node, int size) {
  if (node.kind != YamlTree::Kind::kSequence || static_cast<int>(node.items.size()) != size) {
    throw Refusal{"expected a sequence of " + std::to_string(size) + " numbers, found " +
                  (node.kind == YamlTree::Kind::kSequence
                       ? std::to_string(node.items.size()) + " items"
                       : KindName(node))};
  }
  std::vector<double> values;
  for (const YamlTree& item : node.items) values.push_back(ToDouble(item));
  return values;
}

/// Reads the node into the member that the field points to.
struct Assign {
  const YamlTree& node;
  const Field& field;

  void operator()(double* v) const { *v = ToDouble(node); }
  void operator()(int* v) const { *v = ToInteger<int>(node); }
  void operator()(std::int64_t* v) const { *v = ToInteger<std::int64_t>(node); }
  void operator()(std::uint64_t* v) const { *v = ToInteger<std::uint64_t>(node); }
  void operator()(bool* v) const {
    if (node.kind != YamlTree::Kind::kScalar || node.quoted ||
        (node.scalar != "true" && node.scalar != "false")) {
      throw Refusal{"expected true or false, found " + KindName(node)};
    }
    *v = node.scalar == "true";
  }
  void operator()(std::string* v) const {
    if (node.kind != YamlTree::Kind::kScalar) {
      throw Refusal{"expected a name, found " + KindName(node)};
    }
    *v = node.scalar;
  }
  void operator()(const NameOrFileRef& v) const { (*this)(v.text); }
  void operator()(const TextRef& v) const { (*this)(v.text); }
  void operator()(const EnumRef& v) const {
    const auto found = std::find(v.names.begin(), v.names.end(), node.scalar);
    if (node.kind != YamlTree::Kind::kScalar || found == v.names.end()) {
      throw Refusal{"expected one of " + FormatRange(field) + ", found " + KindName(node)};
    }
    v.set(static_cast<int>(found - v.names.begin()));
  }
  void operator()(const NumbersRef& v) const {
    const auto values = ToDoubles(node, v.size);
    std::copy(values.begin(), values.end(), v.data);
  }
  void operator()(Interval* v) const {
    const auto values = ToDoubles(node, 2);
    *v = {values[0], values[1]};
  }
  void operator()(const WholeNumbersRef& v) const {
    if (node.kind != YamlTree::Kind::kSequence) {
      throw Refusal{"expected a sequence of whole numbers, found " + KindName(node)};
    }
    v.list->clear();
    for (const YamlTree& item : node.items) v.list->push_back(ToInteger<int>(item));
  }
  void operator()(const RowsRef& v) const {
    if (node.kind != YamlTree::Kind::kSequence) {
      throw Refusal{"expected a sequence of rows, found " + KindName(node)};
    }
    v.rows->clear();
    for (const YamlTree& row : node.items) v.rows->push_back(ToDoubles(row, v.columns));
  }
  void operator()(const NamesRef& v) const {
    if (node.kind != YamlTree::Kind::kSequence) {
      throw Refusal{"expected a sequence of names, found " + KindName(node)};
    }
    v.list->clear();
    for (const YamlTree& item : node.items) {
      if (item.kind != YamlTree::Kind::kScalar) {
        throw Refusal{"expected a sequence of names, found " + KindName(item) + " in it"};
      }
      v.list->push_back(item.scalar);
    }
  }
  void operator()(const DifferenceRef& v) const {
    if (const auto message = ParseDifference(v, node)) throw Refusal{*message};
  }
};

}  // namespace

EnumRef Name(std::string* value, std::vector<std::string> names) {
  const auto index = [value, names] {
    const auto found = std::find(names.begin(), names.end(), *value);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
  };
  const auto set = [value, names](int i) { *value = names[static_cast<std::size_t>(i)]; };
  return {std::move(names), index, set};
}

std::string KindName(const YamlTree& node) {
  switch (node.kind) {
    case YamlTree::Kind::kNull:
      return "nothing";
    case YamlTree::Kind::kScalar:
      return Quoted(node.scalar);
    case YamlTree::Kind::kSequence:
      return "a sequence";
    case YamlTree::Kind::kMap:
      return "a map";
  }
  return "?";
}

std::string FormatRange(const Field& field) {
  std::string range = std::string(field.limits.lo_excluded ? "(" : "[") +
                      FormatBound(field.limits.lo) + ", " + FormatBound(field.limits.hi) + "]";
  return std::visit(
      Overload{[&](double*) { return range; }, [&](int*) { return range; },
               [&](std::int64_t*) { return range; },
               [](std::uint64_t*) { return std::string("[0, 18446744073709551615]"); },
               [](bool*) { return std::string("true | false"); },
               [](std::string*) { return std::string(kNameRule); },
               [](const NameOrFileRef& v) {
                 return std::string(kNameRule) + "; or a path without blanks to a " + v.extension +
                        " file";
               },
               [](const EnumRef& v) { return JoinNames(v.names); },
               [&](const NumbersRef&) { return range; },
               [&](Interval*) { return range + ", low <= high"; },
               [&](const WholeNumbersRef& v) {
                 return "1 to " + std::to_string(v.most) + " whole numbers in " + range;
               },
               [](const TextRef&) { return std::string("any text in one line"); },
               [&](const RowsRef& v) {
                 return "any number of rows of " + std::to_string(v.columns) + " in " + range;
               },
               [](const NamesRef& v) { return "any number of " + JoinNames(v.names); },
               [](const DifferenceRef& v) { return FormatRange(*v.of); }},
      field.value);
}

std::optional<std::string> CheckValue(const Field& field) {
  using Result = std::optional<std::string>;
  return std::visit(
      Overload{[&](double* v) { return CheckNumbers(field, v, 1); },
               [&](int* v) { return CheckWhole(field, *v); },
               [&](std::int64_t* v) { return CheckWhole(field, *v); },
               [](std::uint64_t*) -> Result { return {}; }, [](bool*) -> Result { return {}; },
               [&](std::string* v) -> Result {
                 if (IsName(*v)) return {};
                 return Quoted(*v) + " is not a name (" + FormatRange(field) + ", 64 at most)";
               },
               [&](const NameOrFileRef& v) -> Result {
                 if (IsName(*v.text) || IsFile(*v.text, v.extension)) return {};
                 if (v.text->find_first_not_of(" \t") == std::string::npos) {
                   return Quoted(*v.text) + " is blank, neither a name nor a path to a " +
                          v.extension + " file";
                 }
                 return Quoted(*v.text) + " is not a name (" + FormatRange(field) + ", 64 at most)";
               },
               [&](const EnumRef& v) -> Result {
                 if (v.get() >= 0 && static_cast<std::size_t>(v.get()) < v.names.size()) return {};
                 return "must be one of " + FormatRange(field);
               },
               [&](const NumbersRef& v) { return CheckNumbers(field, v.data, v.size); },
               [&](Interval* v) -> Result {
                 const double ends[] = {v->lo, v->hi};
                 if (auto message = CheckNumbers(field, ends, 2)) return message;
                 if (v->lo > v->hi)
                   return "low " + FormatNumber(v->lo) + " is above high " + FormatNumber(v->hi);
                 return {};
               },
               [&](const WholeNumbersRef& v) -> Result {
                 if (v.list->empty() || v.list->size() > static_cast<std::size_t>(v.most)) {
                   return "needs " + FormatRange(field);
                 }
                 for (const int x : *v.list) {
                   if (auto message = CheckWhole(field, x)) return message;
                 }
                 return {};
               },
               [](const TextRef& v) -> Result {
                 const auto control = [](unsigned char c) { return c < 0x20; };
                 if (std::none_of(v.text->begin(), v.text->end(), control)) return {};
                 return Quoted(*v.text) + " is not text in one line";
               },
               [&](const RowsRef& v) -> Result {
                 for (const auto& row : *v.rows) {
                   if (static_cast<int>(row.size()) != v.columns) {
                     return "a row has " + std::to_string(row.size()) + " numbers, not " +
                            std::to_string(v.columns);
                   }
                   if (auto message = CheckNumbers(field, row.data(), v.columns)) return message;
                 }
                 return {};
               },
               [](const NamesRef& v) -> Result {
                 for (const std::string& name : *v.list) {
                   if (std::find(v.names.begin(), v.names.end(), name) == v.names.end()) {
                     return Quoted(name) + " is none of " + JoinNames(v.names);
                   }
                 }
                 return {};
               },
               [](const DifferenceRef& v) -> Result { return CheckDifference(v); }},
      field.value);
}

std::optional<std::string> ParseValue(const Field& field, const YamlTree& node) {
  try {
    std::visit(Assign{node, field}, field.value);
  } catch (const Refusal& refusal) {
    return refusal.message;
  }
  return CheckValue(field);
}

std::optional<std::string> ParseText(const Field& field, const std::string& text) {
  if (const auto* free = std::get_if<TextRef>(&field.value)) {
    *free->text = text;
    return CheckValue(field);
  }
  const bool list = std::holds_alternative<WholeNumbersRef>(field.value) && text.find('[') != 0;
  return ParseValue(field, ParseYaml(list ? "[" + text + "]" : text, field.path, false));
}

}  // namespace stg::config

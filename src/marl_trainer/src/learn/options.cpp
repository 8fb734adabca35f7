#include "marl_trainer/learn/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/checked_json.hpp"

namespace stg::learn {
namespace {

constexpr std::size_t kMaxList = 7;  // as many hidden layers as a policy file may have

/// Shortest text that reads back as the same number: bounds reach from 1e-12 to 1e12.
std::string Text(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general).ptr;
  return {text, end};
}

void RequireRange(const Option& option, double value) {
  RequireOption(
      std::isfinite(value) && value >= option.range.lo && value <= option.range.hi, option.name,
      Text(value) + " is not in [" + Text(option.range.lo) + ", " + Text(option.range.hi) + "]");
}

struct RangeCheck {
  const Option& option;

  void operator()(const double* value) const { RequireRange(option, *value); }
  void operator()(const int* value) const { RequireRange(option, *value); }
  void operator()(const std::int64_t* value) const {
    RequireRange(option, static_cast<double>(*value));
  }
  void operator()(const std::vector<int>* values) const {
    RequireOption(!values->empty() && values->size() <= kMaxList, option.name,
                  "needs 1 to " + std::to_string(kMaxList) + " numbers");
    for (const int value : *values) RequireRange(option, value);
  }
  void operator()(const std::uint64_t*) const {}
  void operator()(const bool*) const {}
  void operator()(const std::string* value) const {
    const std::vector<std::string>& choices = option.choices;
    if (choices.empty() || std::find(choices.begin(), choices.end(), *value) != choices.end()) {
      return;
    }
    std::string known = choices.front();
    for (std::size_t k = 1; k < choices.size(); ++k) known += " or " + choices[k];
    RequireOption(false, option.name, "'" + *value + "' is not " + known);
  }
};

}  // namespace

void RequireOption(bool ok, const std::string& option, const std::string& what) {
  if (!ok) throw UserError("--" + option + ": " + what);
}

void OptionTable::RequireRanges() const {
  for (const Option& option : options_) std::visit(RangeCheck{option}, option.value);
  for (const auto& check : checks_) check();
}

void OptionTable::Dump(nlohmann::ordered_json* json) const {
  for (const Option& option : options_) {
    std::visit([&](const auto* value) { (*json)[option.name] = *value; }, option.value);
  }
}

void OptionTable::Read(const nlohmann::ordered_json& json) const {
  for (const Option& option : options_) {
    std::visit([&](auto* value) { TakeMember(json, option.name, value); }, option.value);
  }
}

}  // namespace stg::learn

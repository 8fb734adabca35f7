#include "marl_trainer/learn/options.hpp"

#include <algorithm>
#include <stdexcept>

#include "auv_common/config/value.hpp"
#include "auv_common/error.hpp"
#include "marl_trainer/learn/checked_json.hpp"

namespace stg::learn {
namespace {

/// Calls `f` with a pointer to the option's value. The type is one that JSON has: flag, text,
/// number, whole number or list of them.
template <class F>
void WithValue(const config::Field& option, const F& f) {
  const auto none = [&option] {
    throw std::logic_error(option.path + " has a type that options do not support");
  };
  std::visit(config::Overload{[&](const config::EnumRef& v) {
                                std::string name = v.names.at(static_cast<std::size_t>(v.get()));
                                f(&name);
                                const auto found = std::find(v.names.begin(), v.names.end(), name);
                                if (found == v.names.end()) {
                                  throw UserError(option.path + ": " + config::Quoted(name) +
                                                  " is not one of " + config::FormatRange(option));
                                }
                                v.set(static_cast<int>(found - v.names.begin()));
                              },
                              [&](const config::TextRef& v) { f(v.text); },
                              [&](const config::WholeNumbersRef& v) { f(v.list); },
                              [&](config::Interval*) { none(); }, [&](auto* v) { f(v); },
                              [&](const auto&) { none(); }},
             option.value);
}

}  // namespace

void RequireOption(bool ok, const std::string& option, const std::string& what) {
  if (!ok) throw UserError("--" + option + ": " + what);
}

void RequireRanges(const config::Table& options) {
  for (const config::Field& option : options.fields()) {
    const auto message = config::CheckValue(option);
    RequireOption(!message, option.path, message.value_or(""));
  }
}

void DumpOptions(const config::Table& options, nlohmann::ordered_json* json) {
  for (const config::Field& option : options.fields()) {
    WithValue(option, [&](const auto* value) { (*json)[option.path] = *value; });
  }
}

void ReadOptions(const config::Table& options, const nlohmann::ordered_json& json) {
  for (const config::Field& option : options.fields()) {
    WithValue(option, [&](auto* value) { TakeMember(json, option.path, value); });
  }
}

}  // namespace stg::learn

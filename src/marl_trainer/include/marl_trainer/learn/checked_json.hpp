#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "auv_common/config/yaml_tree.hpp"
#include "auv_common/error.hpp"

/// Reads values of JSON files that users can edit. The conversions of the JSON library are not safe
/// for this: they cut fractions, wrap numbers out of range (some of this is undefined behaviour),
/// and accept true as 1.
namespace stg::learn {

/// True if a number is whole and fits into Integer. `value` is only set in this case.
template <class Integer, class Json>
bool TakeWhole(const Json& json, Integer* value) {
  using Limits = std::numeric_limits<Integer>;
  constexpr double kWholeInDoubles = 9007199254740992.0;  // 2^53
  if (json.is_number_float()) {
    const auto number = json.template get<double>();
    if (!(std::abs(number) <= kWholeInDoubles) || std::trunc(number) != number) return false;
    return TakeWhole(Json(static_cast<std::int64_t>(number)), value);
  }
  if (!json.is_number_integer()) return false;
  if (!json.is_number_unsigned()) {
    const auto number = json.template get<std::int64_t>();
    if (number < 0) {
      if (!std::is_signed_v<Integer> || number < static_cast<std::int64_t>(Limits::lowest())) {
        return false;
      }
      *value = static_cast<Integer>(number);
      return true;
    }
  }
  const auto number = json.template get<std::uint64_t>();
  if (number > static_cast<std::uint64_t>(Limits::max())) return false;
  *value = static_cast<Integer>(number);
  return true;
}

/// Sets a flag, text, number, whole number or list of them. Throws UserError, e.g. "'1e+300' is not
/// ...", if the JSON has another type, if Value cannot hold the number, or if a whole number has a
/// fraction.
template <class Value, class Json>
void TakeJson(const Json& json, Value* value) {
  const auto require = [&json](bool ok, const std::string& what) {
    if (!ok) throw UserError(config::Quoted(json.dump()) + " is not " + what);
  };
  if constexpr (std::is_same_v<Value, bool>) {
    require(json.is_boolean(), "true or false");
    *value = json.template get<bool>();
  } else if constexpr (std::is_same_v<Value, std::string>) {
    require(json.is_string(), "a text");
    *value = json.template get<std::string>();
  } else if constexpr (std::is_floating_point_v<Value>) {
    require(json.is_number(), "a number");
    *value = json.template get<Value>();
  } else if constexpr (std::is_integral_v<Value>) {
    require(TakeWhole(json, value), "a whole number from " +
                                        std::to_string(std::numeric_limits<Value>::lowest()) +
                                        " to " + std::to_string(std::numeric_limits<Value>::max()));
  } else {
    require(json.is_array(), "a list");
    value->clear();
    for (const Json& item : json) TakeJson(item, &value->emplace_back());
  }
}

/// The same as TakeJson for a member of an object. An error begins with the member's name.
template <class Value, class Json>
void TakeMember(const Json& object, const std::string& name, Value* value) {
  if (!object.is_object() || !object.contains(name)) throw UserError(name + ": is missing");
  try {
    TakeJson(object.at(name), value);
  } catch (const UserError& error) {
    throw UserError(name + ": " + error.what());
  }
}

}  // namespace stg::learn

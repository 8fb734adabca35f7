#pragma once

#include <optional>
#include <string>

/// Numbers and bytes as the protocols of modems write them.
namespace stg::acoustics {

/// Upper case.
std::string ToHex(const std::string& bytes);
/// Nothing: an odd number of digits, or something else than a digit.
std::optional<std::string> FromHex(const std::string& digits);
/// A whole number of the range, all of `text`.
std::optional<int> NumberIn(const std::string& text, int lowest, int highest);

}  // namespace stg::acoustics

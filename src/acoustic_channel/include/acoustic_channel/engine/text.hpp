#pragma once

#include <optional>
#include <string>

/// Numbers and bytes in the protocols of modems.
namespace stg::acoustics {

/// Upper case.
std::string ToHex(const std::string& bytes);
/// Empty for an odd number of digits, or for a character that is not a digit.
std::optional<std::string> FromHex(const std::string& digits);
/// With padding and without line ends (RFC 4648).
std::string ToBase64(const std::string& bytes);
/// A whole number in the range; `text` must contain nothing else.
std::optional<int> NumberIn(const std::string& text, int lowest, int highest);
/// A decimal number in the range, with or without a sign; `text` must contain nothing else. `nan`
/// and `inf` are no numbers.
std::optional<double> RealIn(const std::string& text, double lowest, double highest);

}  // namespace stg::acoustics

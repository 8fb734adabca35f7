#pragma once

#include <cstdio>
#include <string>

#include "auv_common/error.hpp"

/// Parts that the command-line programs have in common.
namespace stg {

/// Prints the last line of a program: one JSON object (nlohmann's), which other programs read.
/// Bytes that are not UTF-8, e.g. in the name of a file, become U+FFFD. Throws UserError if this
/// line or an earlier one cannot be written.
template <class Json>
void PrintResult(const Json& json) {
  const std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::printf("%s\n", line.c_str());
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw UserError("standard output cannot be written");
  }
}

/// Throws UserError unless the value of an option is from lo to hi. It refuses NaN; CLI11's
/// range accepts NaN.
inline void CheckOption(const std::string& option, double value, double lo, double hi) {
  if (value >= lo && value <= hi) return;
  char text[96];
  std::snprintf(text, sizeof text, ": %g is not from %g to %g", value, lo, hi);
  throw UserError(option + text);
}

}  // namespace stg

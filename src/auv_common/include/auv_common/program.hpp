#pragma once

#include <cstdio>
#include <string>

#include "auv_common/error.hpp"

/// What the command lines have in common.
namespace stg {

/// Prints the last line of a program: one JSON object (nlohmann's), which other programs read. What
/// is no UTF-8 in it, such as of a file's name, becomes U+FFFD. Throws UserError when this line or
/// one before it cannot be written.
template <class Json>
void PrintResult(const Json& json) {
  const std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::printf("%s\n", line.c_str());
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw UserError("standard output cannot be written");
  }
}

/// Throws UserError unless the value of an option is from lo to hi; NaN is not, which CLI::Range
/// takes.
inline void CheckOption(const std::string& option, double value, double lo, double hi) {
  if (value >= lo && value <= hi) return;
  char text[96];
  std::snprintf(text, sizeof text, ": %g is not from %g to %g", value, lo, hi);
  throw UserError(option + text);
}

}  // namespace stg

#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace stg::learn {

/// Checks a seed on a command line, because CLI11 would turn -1 into 2^64 - 1.
inline CLI::Validator SeedCheck() {
  return CLI::Validator(
      [](std::string& text) {
        return text.find('-') == std::string::npos ? ""
                                                   : "a seed is a whole number from 0, not " + text;
      },
      "");
}

}  // namespace stg::learn

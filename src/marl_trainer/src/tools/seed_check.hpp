#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace stg::learn {

/// A seed on a command line. CLI11 would make 2^64 - 1 of -1.
inline CLI::Validator SeedCheck() {
  return CLI::Validator(
      [](std::string& text) {
        return text.find('-') == std::string::npos ? ""
                                                   : "a seed is a whole number from 0, not " + text;
      },
      "");
}

}  // namespace stg::learn

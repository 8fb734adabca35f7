#pragma once

#include <stdexcept>
#include <string>

namespace stg {

/// Bad input from a user (scenario file, policy file, command line, bag). The message names file,
/// line and key if they are known. Programs print it and exit with status 2. No part of the bad
/// input takes effect.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stg

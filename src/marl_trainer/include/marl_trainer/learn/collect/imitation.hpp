#pragma once

#include <cstdint>
#include <string>

#include "marl_trainer/learn/options.hpp"

namespace stg::learn {

/// Imitation of a built-in controller at the start of a training. An algorithm may have this stage.
/// The collection asks the teacher in every visited state, and a part of the algorithm's loss is
/// for imitation.
struct ImitationConfig {
  std::string controller;  ///< name, with constants, see agent::ParseBuiltin; empty: none
  std::int64_t steps = 0;
  double share = 1.0;
  double focus = 1.0;
  bool privileged = false;

  void Describe(config::Table* table);
  /// Throws UserError that names the option.
  void ValidateOrThrow() const;

  /// Share of the actor's loss that is imitation after this number of environment steps. It is
  /// constant for the first half of `steps` and then falls to 0.
  double Weight(std::int64_t env_steps) const;
};

}  // namespace stg::learn

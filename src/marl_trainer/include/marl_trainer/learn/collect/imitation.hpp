#pragma once

#include <cstdint>
#include <string>

#include "marl_trainer/learn/options.hpp"

namespace stg::learn {

/// Imitation of a built-in controller at the start of a training, a stage that an algorithm may
/// have: the collection asks the teacher at every state that is visited, and the algorithm's loss
/// has a part for it.
struct ImitationConfig {
  std::string controller;  ///< with constants, see agent::ParseBuiltin; empty: none
  std::int64_t steps = 0;
  double share = 1.0;
  double focus = 1.0;
  bool privileged = false;

  void Describe(config::Table* table);
  /// Throws UserError naming the option.
  void ValidateOrThrow() const;

  /// Share of the actor's loss that is imitation after so many environment steps: in full for the
  /// first half of `steps`, then ever less.
  double Weight(std::int64_t env_steps) const;
};

}  // namespace stg::learn

#pragma once

#include <algorithm>

#include "stg_agent/controllers/controller.hpp"

namespace stg::agent {

/// Commands zero velocity, or zero force.
struct Idle {
  template <class T>
  void Act(const ControllerInput<T>& input, T* action) const {
    std::fill(action, action + input.model.control.action_size(), T(0.0));
  }
};

std::unique_ptr<Controller> MakeIdle();

}  // namespace stg::agent

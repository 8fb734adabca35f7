#pragma once

#include <memory>

#include "auv_dynamics/navigation/navigation_system.hpp"

/// The navigation systems of this package: docs/navigation.md describes them, their code stands in
/// the file of their name.
namespace stg::dynamics {

std::unique_ptr<NavigationSystem> MakeDeadReckoning(const NavigationSetup& setup);

}  // namespace stg::dynamics

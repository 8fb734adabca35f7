#include "stg_agent/controllers/idle.hpp"

namespace stg::agent {

std::unique_ptr<Controller> MakeIdle() { return std::make_unique<ControllerOf<Idle>>(Idle()); }

}  // namespace stg::agent

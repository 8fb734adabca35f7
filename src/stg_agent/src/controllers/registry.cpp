#include "stg_agent/controllers/controller.hpp"
#include "stg_agent/controllers/encircle.hpp"
#include "stg_agent/controllers/idle.hpp"
#include "stg_agent/controllers/pursuit.hpp"

namespace stg::agent {

ControllerRegistry& Controllers() {
  static ControllerRegistry registry("controller", {
                                                       {"encircle", MakeEncircle},
                                                       {"idle", MakeIdle},
                                                       {"pursuit", MakePursuit},
                                                       {"pursuit_separated", MakePursuitSeparated},
                                                   });
  return registry;
}

std::string DefaultController() { return "pursuit_separated"; }

}  // namespace stg::agent

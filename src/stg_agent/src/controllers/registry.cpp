#include "stg_agent/controllers/assign.hpp"
#include "stg_agent/controllers/controller.hpp"
#include "stg_agent/controllers/encircle.hpp"
#include "stg_agent/controllers/formation.hpp"
#include "stg_agent/controllers/idle.hpp"
#include "stg_agent/controllers/pursuit.hpp"
#include "stg_agent/controllers/search_laws.hpp"

namespace stg::agent {

ControllerRegistry& Controllers() {
  static ControllerRegistry registry("controller", {
                                                       {"assign", MakeAssign},
                                                       {"contain", MakeContain},
                                                       {"encircle", MakeEncircle},
                                                       {"expanding_square", MakeExpandingSquare},
                                                       {"formation", MakeFormation},
                                                       {"greedy_search", MakeGreedySearch},
                                                       {"idle", MakeIdle},
                                                       {"parallel_sweep", MakeParallelSweep},
                                                       {"pursuit", MakePursuit},
                                                       {"pursuit_separated", MakePursuitSeparated},
                                                       {"search_map", MakeSearchMap},
                                                   });
  return registry;
}

std::string DefaultController() { return "pursuit_separated"; }

std::string WaitingController() { return "idle"; }

}  // namespace stg::agent

#include "stg_agent/controllers/pursuit.hpp"

namespace stg::agent {
namespace {

std::unique_ptr<Controller> Make(PursuitOptions options, ControllerConstants* constants) {
  VisitPursuitOptions(options, [&](const char* name, double& field, const char*) {
    constants->Read(name, &field == &options.cap ? 1.0 : 1e3, &field);
  });
  return std::make_unique<ControllerOf<Pursuit>>(Pursuit{options});
}

}  // namespace

PursuitOptions TunedPursuit() { return PursuitOptions(); }

PursuitOptions TunedPursuitSeparated() {
  PursuitOptions o;
  o.gain_per_s = 3.0;
  o.standoff_m = 0.0142;
  o.repulsion_gain_per_s = 2.0;
  return o;
}

std::unique_ptr<Controller> MakePursuit(ControllerConstants& constants) {
  return Make(TunedPursuit(), &constants);
}

std::unique_ptr<Controller> MakePursuitSeparated(ControllerConstants& constants) {
  return Make(TunedPursuitSeparated(), &constants);
}

}  // namespace stg::agent

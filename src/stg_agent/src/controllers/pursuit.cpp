#include "stg_agent/controllers/pursuit.hpp"

namespace stg::agent {

using config::kFraction;
using config::NonNegative;

void Describe(PursuitOptions* o, config::Table* t) {
  t->Add("gain", &o->gain_per_s, NonNegative(1e3), "1/s", "gain");
  t->Add("standoff", &o->standoff_m, NonNegative(1e3), "m", "distance to hold");
  t->Add("cap", &o->cap, kFraction, "-", "largest speed per axis, as a share of the maximum");
  t->Add("repulsion", &o->repulsion_gain_per_s, NonNegative(1e3), "1/s",
         "repulsion gain; 0: neighbours are ignored");
  t->Add("repulsion-range", &o->repulsion_range_m, NonNegative(1e3), "m",
         "neighbours closer than this repel");
  t->Add("tangential-range", &o->tangential_range_m, NonNegative(1e3), "m",
         "closer to the target than this, repulsion only acts sideways");
  for (const char* key : {"repulsion-range", "tangential-range"}) {
    t->Own(key, {"repulsion", {"above 0"}, "repulsion", [o] {
                   return std::vector<std::string>{o->repulsion_gain_per_s > 0.0 ? "above 0" : "0"};
                 }});
  }
  t->Add("feedforward", &o->feedforward, NonNegative(1e3), "-",
         "share of the target's velocity that is added");
  t->Add("approach-speed", &o->approach_speed_mps, NonNegative(1e3), "m/s",
         "speed above which the gain is approach-gain");
  t->Add("approach-gain", &o->approach_gain_per_s, NonNegative(1e3), "1/s",
         "gain above approach-speed");
  t->Add("wall-margin", &o->wall_margin_m, NonNegative(1e3), "m",
         "the law pursues no point closer to a wall than this");
}

std::unique_ptr<Controller> MakePursuit(const PursuitOptions& options) {
  return std::make_unique<ControllerOf<Pursuit>>(Pursuit{options});
}

std::unique_ptr<Controller> MakePursuitSeparated(const PursuitSeparatedOptions& options) {
  return MakePursuit(options);
}

}  // namespace stg::agent

// A program outside the repository: it adds a controller of its own, flies it against a shipped one
// on the same episodes, and prints both. See docs/how_to/README.md.

#include <cstdio>
#include <exception>
#include <memory>
#include <string>

#include "auv_common/parallel/worker_pool.hpp"
#include "auv_common/plugin.hpp"
#include "stg_agent/controllers/controller.hpp"
#include "stg_env/env/evaluation.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace {

using namespace stg;

/// Moves towards the target and around it at the same time. Near the target, most of the motion is
/// around it.
struct Spiral {
  double speed = 0.5;  // share of the largest velocity, [0, 1]

  template <class T>
  void Act(const agent::ControllerInput<T>& in, T* action) const {
    const agent::Knowledge<T>& k = in.knowledge;
    const Vec3<T> ahead = k.r_BT_W * (T(1.0) / Max(k.distance, T(1e-9)));
    const T near = Max(T(1.0) - k.distance, T(0.0));
    const Vec3<T> velocity = (ahead + Vec3<T>{ahead.y, -ahead.x, T(0.0)} * near) * T(speed);
    const T wanted[3] = {Clip(velocity.x, T(-1.0), T(1.0)), Clip(velocity.y, T(-1.0), T(1.0)),
                         Clip(velocity.z, T(-1.0), T(1.0))};
    agent::AskForVelocity(in, wanted, action);
  }
};

void Describe(Spiral* o, config::Table* t) {
  t->Add("speed", &o->speed, config::kFraction, "-", "speed as a share of the largest velocity");
}

std::unique_ptr<agent::Controller> MakeSpiral(const Spiral& spiral) {
  return std::make_unique<agent::ControllerOf<Spiral>>(spiral);
}

int Fly() {
  stg_plugin_register();
  const Scenario scenario = LoadNamedScenario(STG_SCENARIOS, "medium", "nominal", {});
  WorkerPool pool(2);
  env::EvaluationOptions options;
  options.episodes = 4;
  for (const std::string name : {"spiral:speed=0.3", "pursuit_separated"}) {
    const auto episodes = env::Evaluate(env::EnvFactory(scenario),
                                        agent::MakeDecider(name, scenario.model()), options, &pool);
    const task::MetricSummary summary = task::Summarise(episodes);
    std::printf("%s %.17g %.17g\n", name.c_str(), summary.Mean("return"),
                summary.Mean("tail_distance"));
  }
  return 0;
}

}  // namespace

STG_PLUGIN { agent::Controllers().Add("spiral", MakeSpiral); }

int main() {
  try {
    return Fly();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "spiral: %s\n", error.what());
    return 2;
  }
}

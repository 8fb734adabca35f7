#include "marl_trainer/learn/checkpoint/checkpoint.hpp"

#include <cmath>
#include <memory>

#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/learn/algorithm.hpp"
#include "marl_trainer/learn/collect/collector.hpp"
#include "marl_trainer/learn/train_config.hpp"
#include "stg_env/scenario/scenario.hpp"
#include "target.hpp"

namespace stg::fuzz {
namespace {

/// A small learner, whose checkpoints have a few kilobytes.
learn::Algorithm& Learner() {
  static WorkerPool pool(1);
  static learn::TrainSetup setup = [] {
    learn::TrainSetup small(learn::DefaultAlgorithm(), "fast");
    const config::Table table = small.Options();
    for (const config::Field& option : table.fields()) {
      if (const auto* widths = std::get_if<config::WholeNumbersRef>(&option.value)) {
        *widths->list = {1};
      }
    }
    return small;
  }();
  static const Scenario scenario =
      LoadNamedScenario(STG_SCENARIOS, "medium", "nominal", {"agents=2"});
  static const std::unique_ptr<learn::Algorithm> algorithm = setup.own->Make(
      setup.common, learn::ProblemOf(scenario.run, scenario.world, scenario.agent), &pool);
  return *algorithm;
}

/// The file of a payload, with the right checksum, because a fuzzer cannot guess it.
std::string WithHeader(const std::string& payload) {
  std::uint64_t checksum = 14695981039346656037ULL;
  for (const char c : payload) {
    checksum = (checksum ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  }
  std::string bytes = "STGTRAIN";
  const std::uint32_t version[2] = {3, 0};
  const std::uint64_t rest[2] = {payload.size(), checksum};
  bytes.append(reinterpret_cast<const char*>(version), sizeof version);
  bytes.append(reinterpret_cast<const char*>(rest), sizeof rest);
  return bytes + payload;
}

}  // namespace

/// The content after a checkpoint's header. An accepted one has possible counts and a learner.
bool RunCheckpoint(const std::string& bytes) {
  return LoadAsFile(WithHeader(bytes), [](const std::string& path) {
    const learn::TrainState state = learn::LoadCheckpoint(path);
    Require(state.env_steps >= 0 && state.collections >= 0 && state.wall_seconds >= 0.0,
            "a checkpoint of negative counts");
    Learner().Load(state.algorithm);
  });
}

}  // namespace stg::fuzz

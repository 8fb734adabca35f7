#pragma once

#include <string>
#include <vector>

#include "auv_common/config/files.hpp"
#include "auv_common/numbers/random.hpp"
#include "stg_env/env/vector_env.hpp"
#include "stg_env/scenario/scenario.hpp"

/// What the tests of the environment share.
namespace stg::env {

inline Scenario Shipped(const std::string& name, const std::string& condition = "nominal",
                        const std::vector<std::string>& overrides = {}) {
  return LoadNamedScenario(STG_SCENARIO_FOLDER, name, condition, overrides);
}

/// The scenario with episodes of `steps` decisions.
inline Scenario Short(Scenario s, int steps) {
  s.run.time.episode_steps = steps;
  s.run.time.tail_steps = std::min(s.run.time.tail_steps, steps);
  return s;
}

inline constexpr int kEnvs = 4;  ///< environments of a TestEnv, unless its options say otherwise

/// Environments that own their arrays.
class TestEnv : public VectorEnv {
 public:
  explicit TestEnv(const Scenario& s, const VectorEnvOptions& o = {})
      : VectorEnv(s, o), memory(MakeMemory()) {}

  void Reset() { VectorEnv::Reset(memory.arrays()); }
  void RestartAt(std::uint64_t k) { VectorEnv::RestartAt(k, memory.arrays()); }
  void ResetEnv(int env, std::uint64_t seed) { VectorEnv::ResetEnv(env, seed, memory.arrays()); }
  void Place(const std::vector<Vec3<double>>& p_WB, const std::vector<Vec3<double>>& p_WT,
             const std::vector<Vec3<double>>& v_WT) {
    VectorEnv::Place(p_WB, p_WT, v_WT, memory.arrays());
  }
  void Step(const std::vector<float>& actions) { VectorEnv::Step(actions.data(), memory.arrays()); }
  bool truncated(int env = 0) const { return memory.truncated[static_cast<std::size_t>(env)] != 0; }

  EnvMemory memory;
};

/// A random action for every AUV, decision and global reset r = first_env + env + round *
/// total_envs. It does not depend on which process runs the reset. Shape [envs, agents,
/// action_size].
inline std::vector<float> ActionsOf(const TestEnv& env, const VectorEnvOptions& o) {
  const int total = o.total_envs > 0 ? o.total_envs : o.envs;
  std::vector<float> actions;
  for (int e = 0; e < env.envs(); ++e) {
    const std::uint64_t r = static_cast<std::uint64_t>(o.first_env + e) +
                            env.round(e) * static_cast<std::uint64_t>(total);
    for (int i = 0; i < env.agents(); ++i) {
      Random random(77 + r, Stream::kPolicy, 0, static_cast<std::uint32_t>(env.step(e)),
                    static_cast<std::uint32_t>(i));
      for (int k = 0; k < env.action_size(); ++k) {
        actions.push_back(static_cast<float>(random.Uniform(-1.0, 1.0)));
      }
    }
  }
  return actions;
}

/// Zero for every AUV: AUVs at rest stay where they are.
inline std::vector<float> Idle(const TestEnv& env) {
  return std::vector<float>(static_cast<size_t>(env.envs() * env.agents() * env.action_size()),
                            0.0F);
}

inline const float* Row(const TestEnv& env, int e, int i) { return env.memory.observation(e, i); }

/// First index of each block of the observation (docs/environment.md).
enum ObservationIndex {
  kOwnPosition = 0,
  kTargetOffset = 15,
  kNeighbours = 18,
  kTargetVelocity = 30,
  kPreviousTau = 45,
  kTracking = 51,
  kShownConfidence = kTracking + 5,
  kSemantic = 59,
  kGraph = 68,
};

}  // namespace stg::env

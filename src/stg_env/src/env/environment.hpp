#pragma once

#include <array>
#include <memory>
#include <vector>

#include "auv_dynamics/helm/helm.hpp"
#include "sources/information_source.hpp"
#include "stg_env/scenario/scenario.hpp"
#include "stg_env/task/task.hpp"

namespace stg::env {

class AcousticSource;

/// kLanes environments of one scenario, one per SIMD lane, each in its own episode. The world moves
/// the AUVs, an information source provides their knowledge, and the task computes reward and
/// metrics.
class Environment {
 public:
  explicit Environment(const Scenario& scenario);
  ~Environment();
  Environment(Environment&&) noexcept;

  /// Sets one lane to the start of an episode of `episode_steps` decisions, drawn from a seed or
  /// from given world positions and target velocities. Begin must follow, for any number of lanes.
  void Reset(int lane, std::uint64_t seed, dynamics::ResetStage stage, int episode_steps);
  void Place(int lane, const std::vector<Vec3<double>>& p_WB, const std::vector<Vec3<double>>& p_WT,
             const std::vector<Vec3<double>>& v_WT);
  void Begin(const LaneSet& lanes);

  /// One decision of every AUV of every lane, in two halves. Move: the AUVs act and the world
  /// moves. Judge: the AUVs get their new knowledge, and the task judges. @param wanted [agents,
  /// action_size], finite
  void Move(const Pack* wanted);
  void Judge();
  /// Whether the lane has made all decisions of its episode.
  bool Done(int lane) const { return task_.steps(lane) >= Lane(length_, lane); }

  /// Rows of the first `lanes` lanes: [agents, observation_size], [state_size], [agents].
  void WriteObservations(int lanes, float* rows) const;
  void WriteStates(int lanes, float* rows) const;
  void WriteRewards(int lanes, float* rows) const;

  /// The target that an AUV follows.
  int followed(int lane, int i) const {
    if (following_ == nullptr) return scenario_.world.target.of(i);
    return static_cast<int>(Lane(following_->target[static_cast<std::size_t>(i)], lane));
  }

  const Scenario& scenario() const { return scenario_; }
  const agent::AgentModel& model() const { return model_; }
  const dynamics::World& world() const { return world_; }
  const task::Task<Pack>& task() const { return task_; }
  const agent::Knowledge<Pack>& knowledge(int i) const { return source_->knowledge(i); }
  /// Knowledge of an AUV from its true state and its true target, without neighbours.
  agent::Knowledge<Pack> Truth(int i) const;
  AcousticSource& acoustic() const;  ///< acoustic mode only

 private:
  void Steer();
  void Zero(int lane, int episode_steps);
  task::SwarmState<Pack> Swarm() const;
  void LookAround();
  void AskWhatTheyFollow();

  Scenario scenario_;
  agent::AgentModel model_;  // the agents' model
  dynamics::World world_;
  std::unique_ptr<InformationSource> source_;
  task::Task<Pack> task_;
  int observation_size_;
  Pack length_ = Pack(0.0);  // decisions of the episode of each lane
  Pack link_quality_ = Pack(0.0);
  std::array<double, dynamics::kWrenchSize>
      share_;  // largest force of the agents' model, as a share of the true one
  task::Efforts<Pack> tau_, action_;
  std::vector<dynamics::Wrench<Pack>> wrench_;
  std::vector<task::FieldState<Pack>> field_;         // [agents] in open water; else empty
  std::unique_ptr<task::Following<Pack>> following_;  // null without task.assignment free
  // For vehicles with an autopilot; otherwise null.
  std::unique_ptr<dynamics::Helm> helm_;
  std::vector<Vec3<Pack>> v_des_W_;
};

}  // namespace stg::env

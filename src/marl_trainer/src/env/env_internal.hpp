#pragma once

#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "marl_trainer/env/env.hpp"
#include "stg_agent/agent/agent_lanes.hpp"

namespace stg::env {

/// Sums behind EpisodeMetrics, all lanes at once.
struct EnvGroup::Totals {
  explicit Totals(const Scenario& scenario);
  void Clear();
  void Add(const EnvGroup& env, bool tail);
  task::EpisodeMetrics Metrics(int lane) const;

 private:
  const Scenario scenario_;
  int steps_ = 0, tail_steps_ = 0;
  Pack return_, distance_, tail_error_, tail_lost_, norm_, saturated_, cost_, comm_, band_, pairs_,
      tail_pairs_, separation_, error_, lost_, track_, observation_, coordination_, semantic_,
      crowding_;
  std::vector<Pack> entered_;  // decision at which each AUV first was within d_u
};

/// The agents and channels of every lane.
struct EnvGroup::Acoustic {
  explicit Acoustic(const Scenario& scenario);
  void Start(const dynamics::World& world);
  /// Mean over all ordered pairs of the link quality that the agents know
  /// (unknown neighbour: 0).
  Pack MeanLinkQuality() const;

  std::vector<agent::AgentLanes> agents;                      // [agent]
  std::vector<std::unique_ptr<acoustics::Channel>> channels;  // [lane]
  std::vector<agent::Packet> packets;                         // [agent], scratch of one lane
  std::vector<acoustics::Transmission> offered;
  std::vector<acoustics::Reception> received;
  std::vector<Vec3<double>> positions, velocities;
  Scenario scenario;
};

}  // namespace stg::env

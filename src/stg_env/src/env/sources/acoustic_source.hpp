#pragma once

#include <memory>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "information_source.hpp"
#include "stg_agent/agent/agent_lanes.hpp"

namespace stg::env {

/// Each AUV knows its own navigation, its own detections, its received packets and its cue. It runs
/// the same agents and channel as the ROS graph, kLanes of each.
class AcousticSource : public InformationSource {
 public:
  /// @param model the agents' model, with the clocks and the number of AUVs of the world
  AcousticSource(const agent::AgentModel& model, const acoustics::ChannelConfig& channel,
                 const dynamics::SensingConfig& sensing,
                 const acoustics::LineOfSight& line_of_sight);

  void Start(const dynamics::World& world, const LaneSet& lanes) override;
  void Observe(const dynamics::World& world, const LaneSet& lanes) override;
  void Act(const dynamics::World& world, int i, const Pack* wanted, task::Effort<Pack>* action,
           task::Effort<Pack>* tau) override;
  void Send(const dynamics::World& world) override;
  const agent::Knowledge<Pack>& knowledge(int i) const override {
    return agents_[static_cast<std::size_t>(i)].knowledge();
  }
  /// Mean link quality over all ordered pairs of AUVs, as the agents estimate it; 0 for a neighbour
  /// without a received packet.
  Pack LinkQuality(const dynamics::World& world) const override;
  void Tell(const dynamics::World& world, int i, task::FieldState<Pack>* state) const override;
  void Choose(int i, task::Following<Pack>* following) const override;

  const agent::AgentLanes& agent(int i) const { return agents_[static_cast<std::size_t>(i)]; }
  /// From now on, `observer` gets the reports of all packets of one lane; null: no observer.
  void ObservePackets(int lane, acoustics::PacketObserver* observer) {
    channels_[static_cast<std::size_t>(lane)]->Observe(observer);
  }
  const acoustics::Channel& channel(int lane) const {
    return *channels_[static_cast<std::size_t>(lane)];
  }

 private:
  void TellNavigation(const dynamics::World& world, int i, int lane,
                      task::FieldState<Pack>* f) const;

  int count_;  // number of AUVs
  dynamics::TargetConfig targets_;
  int action_size_;
  std::uint32_t decision_steps_;
  std::vector<agent::AgentLanes> agents_;                      // [agent]
  std::vector<std::unique_ptr<acoustics::Channel>> channels_;  // [lane]
  // Packets to and from the channel, for one lane at a time.
  std::vector<agent::Packet> packets_;
  std::vector<acoustics::Transmission> offered_;
  std::vector<acoustics::Reception> received_;
  std::vector<Vec3<double>> positions_, velocities_;
  std::vector<Mat3<double>> attitudes_;  // [agent]
};

}  // namespace stg::env

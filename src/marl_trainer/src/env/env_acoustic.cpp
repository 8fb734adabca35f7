#include <algorithm>
#include <cassert>

#include "env_internal.hpp"

namespace stg::env {

EnvGroup::Acoustic::Acoustic(const Scenario& s) : scenario(s) {
  const auto n = static_cast<size_t>(s.agents);
  const agent::Agent first(s, 0);
  agents.reserve(n);
  for (int i = 0; i < s.agents; ++i) agents.emplace_back(first, i);
  for (int lane = 0; lane < kLanes; ++lane)
    channels.push_back(acoustics::MakeChannel(s.channel, s));
  packets.resize(n);
  offered.reserve(n);
  received.reserve(8 * n);
  positions.resize(n);
  velocities.resize(n);
}

void EnvGroup::Acoustic::Start(const dynamics::World& world) {
  for (int lane = 0; lane < kLanes; ++lane) {
    channels[static_cast<size_t>(lane)]->Reset(world.seed(lane), world.episode(lane));
    for (int i = 0; i < scenario.agents; ++i) {
      agents[static_cast<size_t>(i)].Reset(lane, world.episode(lane),
                                           world.InitialCue(lane, i, scenario.target_of(i)));
    }
  }
}

Pack EnvGroup::Acoustic::MeanLinkQuality() const {
  Pack sum(0.0);
  for (const agent::AgentLanes& a : agents) sum += a.knowledge().mean_quality;
  return sum / Pack(scenario.agents);
}

const agent::Agent& EnvGroup::agent(int lane, int i) const {
  assert(acoustic_);
  return acoustic_->agents[static_cast<size_t>(i)].agent(lane);
}

const acoustics::Channel& EnvGroup::channel(int lane) const {
  assert(acoustic_);
  return *acoustic_->channels[static_cast<size_t>(lane)];
}

void EnvGroup::AcousticObserve() {
  Acoustic& a = *acoustic_;
  for (int i = 0; i < agents(); ++i) {
    agent::AgentLanes& agent = a.agents[static_cast<size_t>(i)];
    for (int lane = 0; lane < kLanes; ++lane) {
      if (step_ > 0) {
        a.received.clear();
        a.channels[static_cast<size_t>(lane)]->Deliver(i, world_.time(lane), &a.received);
        for (const acoustics::Reception& r : a.received) agent.Receive(lane, r);
      }
      for (int k = 0; k < scenario_.target.count; ++k) {
        dynamics::Detection detection;
        if (world_.Sense(lane, i, k, &detection)) agent.Detect(lane, detection);
      }
    }
    agent.Observe(world_.Nav(i));
  }
}

void EnvGroup::AcousticActions() {
  Acoustic& a = *acoustic_;
  const int n = agents();
  const int size = action_size();
  for (int i = 0; i < n; ++i) {
    const auto ui = static_cast<size_t>(i);
    Pack wanted[6];
    for (int k = 0; k < size; ++k) {
      alignas(64) double buffer[kLanes];
      for (int lane = 0; lane < kLanes; ++lane) {
        buffer[lane] = actions_[static_cast<size_t>((lane * n + i) * size + k)];
      }
      // What a policy says is float.
      wanted[k] = RoundToFloat(Pack::load_aligned(buffer));
    }
    agent::AgentLanes& agent = a.agents[ui];
    agent.Act(wanted);
    std::copy(agent.knowledge().tau, agent.knowledge().tau + 6, tau_[ui].begin());
    std::copy(agent.action().begin(), agent.action().begin() + size, action_[ui].begin());
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    const TimeNs now = world_.time(lane);
    acoustics::Channel& channel = *a.channels[static_cast<size_t>(lane)];
    a.offered.clear();
    for (int i = 0; i < n; ++i) {
      const auto ui = static_cast<size_t>(i);
      a.positions[ui] = Lane(world_.vehicle(i).p_WB, lane);
      a.velocities[ui] = Lane(world_.vehicle(i).v_WB, lane);
      if (!channel.Due(i, now)) continue;
      a.packets[ui] = a.agents[ui].MakePacket(lane);
      acoustics::Transmission& t = a.offered.emplace_back();
      t.source = i;
      t.stamp = t.generation = now;
      t.payload = acoustics::ViewOf(a.packets[ui]);
    }
    channel.Step(now, static_cast<std::uint32_t>(step_), a.positions, a.velocities, a.offered);
  }
}

}  // namespace stg::env

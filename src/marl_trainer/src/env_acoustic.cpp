#include <cassert>

#include "auv_dynamics/control.hpp"
#include "env_internal.hpp"

namespace stg {

EnvGroup::Acoustic::Acoustic(const Scenario& s) : scenario(s) {
  const auto n = static_cast<size_t>(s.agents);
  const Agent first(s, 0);
  agents.reserve(n * kLanes);
  for (int lane = 0; lane < kLanes; ++lane) {
    // Not plain copies: those would lose the memory that an agent reserves.
    for (int i = 0; i < s.agents; ++i) agents.emplace_back(first, i);
    channels.push_back(MakeChannel(s));
  }
  sequence.assign(n * kLanes, 0);
  fraction.assign(n * 6 * kLanes, 0.0);
  action = fraction;
  sent.reserve(n);
  received.reserve(8 * n);
  positions.resize(n);
}

void EnvGroup::Acoustic::Start(const World& world) {
  for (int lane = 0; lane < kLanes; ++lane) {
    channels[static_cast<size_t>(lane)]->Reset(world.seed(lane), world.episode(lane));
    for (int i = 0; i < scenario.agents; ++i) {
      const auto index = static_cast<size_t>(lane * scenario.agents + i);
      agents[index].Reset(world.episode(lane), world.InitialCue(lane, i, scenario.target_of(i)));
      sequence[index] = 0;
    }
  }
}

Pack EnvGroup::Acoustic::MeanLinkQuality() const {
  alignas(64) double mean[kLanes];
  const int n = scenario.agents;
  for (int lane = 0; lane < kLanes; ++lane) {
    mean[lane] = 0.0;
    for (int i = 0; i < n; ++i) {
      mean[lane] += agents[static_cast<size_t>(lane * n + i)].knowledge().mean_quality;
    }
    mean[lane] = mean[lane] / n;
  }
  return Pack::load_aligned(mean);
}

const Agent& EnvGroup::agent(int lane, int i) const {
  assert(acoustic_);
  return acoustic_->agents[static_cast<size_t>(lane * scenario_.agents + i)];
}

const Channel& EnvGroup::channel(int lane) const {
  assert(acoustic_);
  return *acoustic_->channels[static_cast<size_t>(lane)];
}

void EnvGroup::AcousticObserve() {
  Acoustic& a = *acoustic_;
  const int n = agents();
  const auto size = static_cast<size_t>(observation_size_);
  for (int lane = 0; lane < kLanes; ++lane) {
    const TimeNs now = world_.time(lane);
    Channel& channel = *a.channels[static_cast<size_t>(lane)];
    for (int i = 0; i < n; ++i) {
      const auto index = static_cast<size_t>(lane * n + i);
      Agent& agent = a.agents[index];
      if (step_ > 0) {
        a.received.clear();
        channel.Deliver(i, now, &a.received);
        for (const Reception& r : a.received) agent.Receive(r);
      }
      for (int k = 0; k < scenario_.target.count; ++k) {
        Detection detection;
        if (world_.Sense(lane, i, k, &detection)) agent.Detect(detection);
      }
      agent.Observe(world_.Nav(lane, i), observations_.data() + index * size);
    }
  }
}

void EnvGroup::AcousticActions() {
  Acoustic& a = *acoustic_;
  const int n = agents();
  const int size = action_size();
  for (int lane = 0; lane < kLanes; ++lane) {
    a.sent.clear();
    const TimeNs now = world_.time(lane);
    for (int i = 0; i < n; ++i) {
      const auto index = static_cast<size_t>(lane * n + i);
      const auto ui = static_cast<size_t>(i);
      float action[6];
      for (int k = 0; k < size; ++k) {
        action[k] = static_cast<float>(actions_[index * static_cast<size_t>(size) + static_cast<size_t>(k)]);
      }
      const AgentOutput out = a.agents[index].Act(action);
      for (int k = 0; k < 6; ++k) {
        a.fraction[(ui * 6 + static_cast<size_t>(k)) * kLanes + static_cast<size_t>(lane)] =
            out.fraction[k];
        a.action[(ui * 6 + static_cast<size_t>(k)) * kLanes + static_cast<size_t>(lane)] =
            k < size ? out.action[k] : 0.0;
      }
      if (out.transmit) {
        a.sent.push_back({i, a.sequence[index]++, now, out.packet, out.generation});
      }
      a.positions[ui] = Lane(world_.vehicle(i).p_WB, lane);
    }
    a.channels[static_cast<size_t>(lane)]->Step(now, static_cast<std::uint32_t>(step_),
                                                a.positions, a.sent);
  }
  for (size_t k = 0; k < static_cast<size_t>(n) * 6; ++k) {
    tau_[k / 6][k % 6] = Pack::load_unaligned(&a.fraction[k * kLanes]);
    action_[k / 6][k % 6] = Pack::load_unaligned(&a.action[k * kLanes]);
  }
}

}  // namespace stg

#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "auv_common/numbers/attitude.hpp"
#include "packet/packet_examples.hpp"
#include "stg_agent/agent/agent.hpp"

namespace stg::agent {

inline constexpr TimeNs kStep = 100'000'000;

/// The report of a neighbour at a position.
inline NeighbourState Report(int source, TimeNs generation, const Vec3<double>& p_W,
                             const Vec3<double>& v_W = {}) {
  NeighbourState s;
  s.source = source;
  s.generation = generation;
  s.p_W = p_W;
  s.v_W = v_W;
  return s;
}

/// Navigation of a level, unturned AUV at a position, with a world velocity.
inline dynamics::NavState Nav(TimeNs stamp, const Vec3<double>& p_WB,
                              const Vec3<double>& v_WB = {}) {
  dynamics::NavState nav;
  nav.stamp = stamp;
  nav.p_WB = p_WB;
  nav.v_WB_B = v_WB;
  return nav;
}

/// The same navigation in every lane.
inline dynamics::Navigation<Pack> InAllLanes(const dynamics::NavState& nav) {
  dynamics::Navigation<Pack> all;
  all.stamp.fill(nav.stamp);
  all.p_WB = Broadcast(nav.p_WB);
  all.v_WB_B = Broadcast(nav.v_WB_B);
  all.w_WB_B = Broadcast(nav.w_WB_B);
  for (int k = 0; k < 4; ++k) all.q_WB[k] = Pack(nav.q_WB[k]);
  return all;
}

/// A reception that owns its payload.
struct HeardPacket {
  acoustics::Reception reception;
  Packet data;
  operator acoustics::Reception() const {
    acoustics::Reception r = reception;
    r.payload = acoustics::ViewOf(data);
    return r;
  }
};

/// The packet of a state, as the channel delivers it at `arrival`.
inline HeardPacket Heard(const AgentModel& s, const NeighbourState& state, TimeNs arrival) {
  acoustics::Reception r;
  r.source = state.source;
  r.generation = r.transmit = state.generation;
  r.arrival = arrival;
  return {r, PacketCodec(s).Encode(state)};
}

/// All inputs of one agent in one step.
struct Input {
  dynamics::NavState nav;
  std::vector<dynamics::Detection> detections;
  std::vector<HeardPacket> receptions;
  float action[6];
};

/// A seeded episode for one agent: neighbours that wander and report, a target that comes and goes,
/// arbitrary attitudes and actions. All positions are moved by `shift`.
inline std::vector<Input> RandomEpisode(const AgentModel& s, int id, int steps, unsigned seed,
                                        const Vec3<double>& shift = {}, double extent = 0.9,
                                        bool reports_targets = true) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto vector = [&](double scale) {
    return Vec3<double>{scale * u(generator), scale * u(generator), scale * u(generator)};
  };
  const PacketCodec codec(s);
  std::vector<Input> inputs;
  Vec3<double> target = vector(extent);
  const Vec3<double> target_velocity = vector(0.01);
  Vec3<double> own = vector(extent);
  for (int k = 0; k < steps; ++k) {
    Input in;
    target = Clip(target + target_velocity * 0.1, -extent, extent);
    own = Clip(own + vector(0.02), -extent, extent);
    in.nav.stamp = k * kStep;
    in.nav.p_WB = own + shift;
    in.nav.v_WB_B = {1.5 * u(generator), 0.5 * u(generator), 0.5 * u(generator)};
    in.nav.w_WB_B = vector(1.2);
    QuaternionOf(Vec3<double>{3.0 * u(generator), 1.5 * u(generator), 3.0 * u(generator)},
                 &in.nav.q_WB);
    if (u(generator) > 0.3) in.detections.push_back({in.nav.stamp, 0, target + shift, 0.001});
    for (int j = 0; j < s.run.agents; ++j) {
      if (j == id || u(generator) < 0.6) continue;
      NeighbourState n;
      n.source = j;
      n.generation = std::max<TimeNs>(0, in.nav.stamp - kStep);
      n.p_W = vector(extent) + shift;
      n.v_W = vector(0.3);
      n.confidence = std::abs(u(generator));
      n.tracking_error = std::abs(u(generator));
      n.phase = 1;
      n.link_quality = std::abs(u(generator));
      n.has_target = reports_targets && u(generator) > 0.0;
      if (n.has_target) {
        n.target_stamp = n.generation;
        n.p_WT = target + vector(0.01) + shift;
        n.target_std = 0.01;
      }
      in.receptions.push_back(Heard(s, n, in.nav.stamp));
    }
    for (float& a : in.action) a = static_cast<float>(1.5 * u(generator));
    inputs.push_back(in);
  }
  return inputs;
}

/// Runs one step. The observation goes to `observation`.
inline AgentOutput Drive(Agent* agent, const Input& in, std::vector<float>* observation) {
  for (const HeardPacket& r : in.receptions) agent->Receive(r);
  for (const dynamics::Detection& d : in.detections) agent->Detect(d);
  observation->resize(static_cast<std::size_t>(agent->model().observation_size()));
  agent->Observe(in.nav, observation->data());
  return agent->Act(in.action);
}

inline dynamics::Cue CueAt(const Vec3<double>& p_WT, double std_m = 0.05) {
  dynamics::Cue cue;
  cue.p_WT = p_WT;
  cue.std_m = std_m;
  return cue;
}

}  // namespace stg::agent

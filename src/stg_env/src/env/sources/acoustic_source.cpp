#include "acoustic_source.hpp"

#include <algorithm>

#include "auv_common/numbers/attitude.hpp"
#include "stg_agent/stations/station_channel.hpp"

namespace stg::env {

AcousticSource::AcousticSource(const agent::AgentModel& model,
                               const acoustics::ChannelConfig& channel,
                               const dynamics::SensingConfig& sensing,
                               const acoustics::LineOfSight& line_of_sight)
    : count_(model.run.agents),
      targets_(model.target),
      action_size_(model.control.action_size()),
      decision_steps_(static_cast<std::uint32_t>(model.run.time.decision_steps)) {
  const auto n = static_cast<std::size_t>(count_);
  const auto constants = std::make_shared<const agent::AgentConstants>(model);
  agents_.reserve(n);
  for (int i = 0; i < count_; ++i) agents_.emplace_back(constants, i);
  for (int lane = 0; lane < kLanes; ++lane) {
    channels_.push_back(agent::MakeStationChannel(model, channel, sensing, line_of_sight));
  }
  packets_.resize(n);
  offered_.reserve(n);
  received_.reserve(8 * n);
  positions_.resize(static_cast<std::size_t>(channels_.front()->bodies()));
  velocities_.resize(positions_.size());
  attitudes_.resize(n);
}

void AcousticSource::Start(const dynamics::World& world, const LaneSet& lanes) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if (!lanes[lane]) continue;
    channels_[static_cast<std::size_t>(lane)]->Reset(world.seed(lane), world.episode(lane));
    for (int i = 0; i < count_; ++i) {
      agents_[static_cast<std::size_t>(i)].Reset(lane, world.episode(lane),
                                                 world.InitialCue(lane, i, targets_.of(i)));
      for (int k = 0; k < targets_.count; ++k) {
        // The agent ignores a cue of a target that it does not estimate.
        if (k != targets_.of(i)) {
          agents_[static_cast<std::size_t>(i)].AddCue(lane, world.InitialCue(lane, i, k));
        }
      }
    }
  }
}

void AcousticSource::Observe(const dynamics::World& world, const LaneSet& lanes) {
  for (int i = 0; i < count_; ++i) {
    agent::AgentLanes& agent = agents_[static_cast<std::size_t>(i)];
    for (int lane = 0; lane < kLanes; ++lane) {
      if (!lanes[lane]) continue;
      if (world.step(lane) > 0) {
        received_.clear();
        channels_[static_cast<std::size_t>(lane)]->Deliver(i, world.time(lane), &received_);
        for (const acoustics::Reception& r : received_) agent.Receive(lane, r);
      }
      world.SenseTargets(lane, i, [&agent, lane](const dynamics::Detection& detection) {
        agent.Detect(lane, detection);
      });
    }
    if (lanes.all()) {
      agent.Observe(world.Nav(i));
    } else {
      agent.Observe(world.Nav(i), lanes.mask());
    }
  }
}

void AcousticSource::Act(const dynamics::World&, int i, const Pack* wanted,
                         task::Effort<Pack>* action, task::Effort<Pack>* tau) {
  Pack rounded[dynamics::kMaxActionSize];
  // A policy's output is float.
  for (int k = 0; k < action_size_; ++k) rounded[k] = RoundToFloat(wanted[k]);
  agent::AgentLanes& agent = agents_[static_cast<std::size_t>(i)];
  agent.Act(rounded);
  // std::copy of packs is a call, which costs more than they do.
  for (std::size_t k = 0; k < tau->size(); ++k) (*tau)[k] = agent.knowledge().tau[k];
  for (std::size_t k = 0; k < agent.action().size(); ++k) (*action)[k] = agent.action()[k];
}

void AcousticSource::Send(const dynamics::World& world) {
  for (int lane = 0; lane < kLanes; ++lane) {
    const TimeNs now = world.time(lane);
    acoustics::Channel& channel = *channels_[static_cast<std::size_t>(lane)];
    offered_.clear();
    for (int i = 0; i < count_; ++i) {
      const auto u = static_cast<std::size_t>(i);
      positions_[u] = Lane(world.vehicle(i).p_WB, lane);
      velocities_[u] = Lane(world.vehicle(i).v_WB, lane);
      if (!channel.Due(i, now) || !agents_[u].present(lane)) continue;
      packets_[u] = agents_[u].MakePacket(lane);
      acoustics::Transmission& t = offered_.emplace_back();
      t.source = i;
      t.stamp = t.generation = now;
      t.payload = acoustics::ViewOf(packets_[u]);
    }
    for (int k = 0; count_ + k < channel.bodies(); ++k) {
      const auto u = static_cast<std::size_t>(count_ + k);
      positions_[u] = Lane(world.target(k).p_WT, lane);
      velocities_[u] = Lane(world.target(k).v_WT, lane);
    }
    if (channel.measures_directions()) {
      for (int i = 0; i < count_; ++i) {
        double q_WB[4];
        for (int k = 0; k < 4; ++k) q_WB[k] = Lane(world.vehicle(i).q_WB[k], lane);
        attitudes_[static_cast<std::size_t>(i)] = RotationOf(q_WB);
      }
      channel.SetAttitudes(attitudes_);
    }
    const auto decision = world.step(lane) / decision_steps_;
    channel.Step(now, decision, positions_, velocities_, offered_);
  }
}

/// Errors of the positions of AUV i and of the others relative to it, after the localizer's
/// corrections.
void AcousticSource::TellNavigation(const dynamics::World& world, int i, int lane,
                                    task::FieldState<Pack>* f) const {
  const agent::Localizer* localizer = agents_[static_cast<std::size_t>(i)].inbox(lane).localizer();
  if (localizer == nullptr) return;
  const auto error = [&](int j) {
    return world.Nav(lane, j).p_WB - Lane(world.vehicle(j).p_WB, lane);
  };
  const Vec3<double> own = error(i);
  const agent::PlaneError e = localizer->own();
  SetLane(&f->located, lane, 1.0);
  SetLane(&f->navigation_error, lane, {own.x - e.x, own.y - e.y, 0.0});
  const double covariance[3] = {e.xx, e.xy, e.yy};
  for (int k = 0; k < 3; ++k) SetLane(&f->navigation_covariance[k], lane, covariance[k]);
  double square = 0.0;
  int others = 0;
  for (int j = 0; j < count_; ++j) {
    if (j == i || !agents_[static_cast<std::size_t>(j)].present(lane)) continue;
    const Vec3<double> truth = error(j) - own;
    const agent::PlaneError r = localizer->relative(j, world.time(lane));
    square += (truth.x - r.x) * (truth.x - r.x) + (truth.y - r.y) * (truth.y - r.y);
    ++others;
  }
  SetLane(&f->relative_square, lane, square / std::max(1, others));
  const agent::Surfacing* surfacing = agents_[static_cast<std::size_t>(i)].inbox(lane).surfacing();
  if (surfacing == nullptr) return;
  SetLane(&f->surfacing, lane, surfacing->under_way() ? 1.0 : 0.0);
  SetLane(&f->fixes, lane, static_cast<double>(localizer->fixes()));
}

Pack AcousticSource::LinkQuality(const dynamics::World&) const {
  Pack sum(0.0);
  for (const agent::AgentLanes& a : agents_) sum += a.knowledge().mean_quality;
  return sum / Pack(count_);
}

void AcousticSource::Choose(int i, task::Following<Pack>* f) const {
  const agent::AgentLanes& agent = agents_[static_cast<std::size_t>(i)];
  const auto u = static_cast<std::size_t>(i), n = static_cast<std::size_t>(targets_.count);
  for (int lane = 0; lane < kLanes; ++lane) {
    const agent::Inbox& inbox = agent.inbox(lane);
    SetLane(&f->target[u], lane, static_cast<double>(inbox.target()));
    for (std::size_t k = 0; k < n; ++k) {
      const agent::TargetBelief belief = inbox.belief(static_cast<int>(k));
      SetLane(&f->known[u * n + k], lane, agent::Known(agent.model(), belief) ? 1.0 : 0.0);
      SetLane(&f->p_WT[u * n + k], lane, belief.p_WT);
    }
  }
}

void AcousticSource::Tell(const dynamics::World& world, int i, task::FieldState<Pack>* f) const {
  f->r_BT_W = agents_[static_cast<std::size_t>(i)].knowledge().r_BT_W;
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto u = static_cast<std::size_t>(i);
    const TimeNs now = world.time(lane);
    SetLane(&f->present, lane, agents_[u].present(lane) ? 1.0 : 0.0);
    const agent::TargetBelief belief = agents_[u].inbox(lane).belief();
    SetLane(&f->known, lane, belief.started ? 1.0 : 0.0);
    SetLane(&f->p_WT, lane, belief.p_WT);
    const agent::Covariance3& P = belief.P_WT;
    const double covariance[6] = {P.xx, P.xy, P.xz, P.yy, P.yz, P.zz};
    for (int k = 0; k < 6; ++k) SetLane(&f->covariance[k], lane, covariance[k]);
    SetLane(&f->age_s, lane, Seconds(now - belief.information));
    TellNavigation(world, i, lane, f);
    const acoustics::Channel& channel = *channels_[static_cast<std::size_t>(lane)];
    SetLane(&f->modem_energy_j, lane, channel.EnergyJ(i, now));
    SetLane(&f->airtime_s, lane, channel.SentS(i, now));
    const acoustics::PingTotals pings = channel.pings();
    SetLane(&f->pings, lane, static_cast<double>(pings.sent) / count_);
    SetLane(&f->ping_answers, lane, static_cast<double>(pings.answered) / count_);
    const acoustics::ChannelTotals& totals = channel.totals();
    SetLane(&f->received, lane, static_cast<double>(totals.delivered) / count_);
    SetLane(&f->missed, lane, static_cast<double>(totals.dropped) / count_);
  }
}

}  // namespace stg::env

#pragma once

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "auv_common/config/loader.hpp"
#include "auv_dynamics/world/world.hpp"
#include "stg_agent/estimation/target_filter.hpp"

/// AUVs that follow a target and share what they measure. Tests judge filters over many episodes.
namespace stg::agent {

struct FleetOptions {
  std::string sensor = "range";
  int observers = 2;
  double loss = 0.0;  ///< share of packets that are lost
  /// A packet takes between 0 and this time, so packets may change their order.
  double longest_age_s = 2.0;
  double interval_s = 4.0;  ///< time between two packets of one AUV
  bool drift = true;        ///< true: dead reckoning, false: perfect navigation
  double seconds = 240.0;
  std::string motion = "coordinated_turn";
  double turn_rate_radps = 0.02;
  double turn_period_s = 60.0;
  double cue_std_m = 50.0;
  int look_steps = 1;  ///< decisions between two looks of the sensor
  bool pile = false;   ///< all AUVs keep to one place on one side of the target
};

/// A field of 4 km by 4 km with kinematic AUVs that measure every second.
inline AgentScenario FleetScenario(const FleetOptions& o) {
  AgentScenario s;
  s.run.agents = o.observers;
  s.run.time.dt_s = 0.25;
  s.run.time.decision_steps = 4;
  s.world.vehicle.model = "kinematic";
  s.world.vehicle.max_velocity_mps = {2.3, 2.3, 0.5};
  s.world.vehicle.max_rate_radps = {0.2, 0.2, 0.2};
  s.world.vehicle.kinematic.min_speed_mps = 0.0;
  s.world.workspace.half_extent_m = 2000.0;
  s.world.reset.start_half_extent_m = 2000.0;
  s.world.reset.min_separation_m = 20.0;
  for (auto& stage : s.world.reset.stages) {
    stage.target_radius_m = {50.0, 200.0};
    stage.auv_distance_m = {80.0, 250.0};
    stage.target_speed_mps = {0.3, 0.9};
  }
  s.world.sea.open = true;
  s.world.target.motion = o.motion;
  s.world.target.max_speed_mps = 0.9;
  if (o.motion == "coordinated_turn") {
    config::Override(&s, {"target.coordinated_turn.rate_radps=" + std::to_string(o.turn_rate_radps),
                          "target.coordinated_turn.period_s=" + std::to_string(o.turn_period_s)});
  }
  s.world.sensing.sensor = o.sensor;
  s.world.sensing.range_m = 600.0;
  s.world.sensing.noise_std_m = 3.0;
  s.world.sensing.detection_probability = 0.9;
  s.world.sensing.cue_std_m = o.cue_std_m;
  s.world.navigation.kind = o.drift ? "dead_reckoning" : "perfect";
  s.agent.track.filter = "measurements";
  return s;
}

/// Compares an estimate of AUV 0 with the truth.
struct Judgement {
  double nees = 0.0;        ///< squared error in units of the covariance, 3 degrees of freedom
  double error_m = 0.0;     ///< horizontal, in the world
  double relative_m = 0.0;  ///< horizontal, of the vector that the AUV steers by
  double std_m = 0.0;       ///< stated deviation of each component
};

/// Flies the fleet. Calls `judge` with the judgement of AUV 0 and the number of the check, at
/// `checks` times that are spread evenly over an episode.
class Fleet {
 public:
  Fleet(const AgentScenario& scenario, const FleetOptions& options)
      : o_(options),
        s_(scenario.model()),
        codec_(s_, LayoutOf(s_)),
        world_(scenario.world, scenario.run),
        random_(17) {
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int i = 0; i < s_.run.agents; ++i) {
        filters_.push_back(TargetFilters().Make(s_.track.filter, s_, i));
      }
    }
    mail_.resize(filters_.size());
  }

  template <class Judge>
  void Fly(std::uint64_t seed, int checks, const Judge& judge) {
    for (int lane = 0; lane < kLanes; ++lane) {
      world_.Reset(lane, seed + static_cast<std::uint64_t>(lane), 0, dynamics::ResetStage::kMedium);
      for (int i = 0; i < s_.run.agents; ++i) {
        TargetFilter& f = *filters_[At(lane, i)];
        f.Clear();
        const dynamics::Cue cue = world_.InitialCue(lane, i, 0);
        f.Start(cue.p_WT, cue.std_m, 0);
        mail_[At(lane, i)].clear();
      }
    }
    const auto decisions = static_cast<int>(o_.seconds / s_.run.decision_dt_s());
    for (int k = 0; k <= decisions; ++k) {
      for (int lane = 0; lane < kLanes; ++lane) Decide(lane, k);
      if (k > 0 && k % (decisions / checks) == 0) {
        for (int lane = 0; lane < kLanes; ++lane) judge(Of(lane), k / (decisions / checks) - 1);
      }
      Steer(k);
    }
  }

  const AgentModel& model() const { return s_; }
  TargetFilter& filter(int lane, int i) { return *filters_[At(lane, i)]; }
  const dynamics::World& world() const { return world_; }

  Judgement Of(int lane, int i = 0) {
    const TargetBelief b = filter(lane, i).belief();
    const Vec3<double> p_WT = Lane(world_.target(0).p_WT, lane);
    const Vec3<double> error = b.p_WT - p_WT;
    const Vec3<double> relative = filter(lane, i).estimate().p_WT - world_.Nav(lane, i).p_WB -
                                  (p_WT - Lane(world_.vehicle(i).p_WB, lane));
    return {b.P_WT.SquaredNorm(error), std::hypot(error.x, error.y),
            std::hypot(relative.x, relative.y), b.position_std_m()};
  }

 private:
  struct Letter {
    TimeNs arrival;
    Packet packet;
  };
  std::size_t At(int lane, int i) const {
    return static_cast<std::size_t>(lane * s_.run.agents + i);
  }
  double Uniform() { return std::uniform_real_distribution<double>()(random_); }

  void Decide(int lane, int k) {
    const TimeNs now = world_.time(lane);
    const auto interval = static_cast<int>(o_.interval_s / s_.run.decision_dt_s());
    for (int i = 0; i < s_.run.agents; ++i) {
      TargetFilter& f = *filters_[At(lane, i)];
      auto& mail = mail_[At(lane, i)];
      for (std::size_t m = 0; m < mail.size();) {
        if (mail[m].arrival > now) {
          ++m;
          continue;
        }
        f.Hear(codec_.Decode(mail[m].packet.data(), mail[m].packet.size(), mail[m].arrival));
        mail[m] = mail.back();
        mail.pop_back();
      }
      f.Predict(now);
      dynamics::Detection d;
      const bool looks = k % o_.look_steps == 0;
      if (looks && world_.Sense(lane, i, 0, &d)) f.Detect(d);
      f.Settle(now, {world_.Nav(lane, i).position_std_m});
      if ((k + i) % interval == 0) Send(lane, i, now);
    }
  }

  void Send(int lane, int i, TimeNs now) {
    const dynamics::NavState nav = world_.Nav(lane, i);
    NeighbourState state;
    state.source = i;
    state.generation = now;
    state.p_W = nav.p_WB;
    state.v_W = RotationOf(nav.q_WB) * nav.v_WB_B;
    state.position_std_m = nav.position_std_m;
    filters_[At(lane, i)]->Tell(false, &state);
    const Packet packet = codec_.Encode(state);
    for (int j = 0; j < s_.run.agents; ++j) {
      if (j == i || Uniform() < o_.loss) continue;
      const auto age = static_cast<TimeNs>(o_.longest_age_s * Uniform() * 1e9);
      mail_[At(lane, j)].push_back({now + age, packet});
    }
  }

  /// Circles around the target at 60 to 120 m. Each AUV has its own speed and direction.
  void Steer(int) {
    std::vector<Pack> commands;
    for (int i = 0; i < s_.run.agents; ++i) {
      const auto& v = world_.vehicle(i);
      Pack turn(0.0);
      for (int lane = 0; lane < kLanes; ++lane) {
        const Vec3<double> r = Lane(world_.target(0).p_WT, lane) - Lane(v.p_WB, lane);
        const double distance = std::hypot(r.x, r.y);
        const double off = Clip((distance - 90.0) / 60.0, -1.0, 1.0) * 0.5 * kPi;
        const double side = i % 2 == 0 ? 1.0 : -1.0;
        double wanted = std::atan2(r.y, r.x) + side * (0.5 * kPi - off);
        // All AUVs go to a place 90 m east of the target, where they fly circles of a few metres.
        if (o_.pile) wanted = std::atan2(r.y, r.x + 90.0);
        const double heading = Lane(v.rpy.z, lane);
        SetLane(&turn, lane, Clip(WrapAngle(wanted - heading) * 0.5, -0.15, 0.15));
      }
      commands.push_back(Pack(1.2 + 0.2 * (i % 4)));
      commands.push_back(turn);
      commands.push_back(Pack(0.0));
    }
    for (int step = 0; step < s_.run.time.decision_steps; ++step) world_.Step(commands);
  }

  FleetOptions o_;
  AgentModel s_;
  PacketCodec codec_;
  dynamics::World world_;
  std::mt19937_64 random_;
  std::vector<std::unique_ptr<TargetFilter>> filters_;  // [lanes, agents]
  std::vector<std::vector<Letter>> mail_;               // [lanes, agents]
};

}  // namespace stg::agent

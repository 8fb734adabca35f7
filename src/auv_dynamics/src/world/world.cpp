#include "auv_dynamics/world/world.hpp"

#include <algorithm>
#include <cassert>
#include <string>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_common/names.hpp"
#include "auv_dynamics/autopilot/autopilot.hpp"
#include "auv_dynamics/vehicle/fully_actuated.hpp"

namespace stg::dynamics {
namespace {

/// The same as ValidateOrThrow of a WorldScenario, but without the keys of the agents' models. This
/// saves time, because every environment of an evaluation is checked here.
const WorldConfig& Valid(const WorldConfig& config, const RunConfig& run) {
  WorldConfig world = config;  // a table refers to values that it may change
  RunConfig steps = run;
  config::Table table;
  Describe(&steps, &table);
  Describe(&world, &table);
  auto violation = config::FindBadValue(table);
  if (!violation) violation = FindConflict(WorldScenario{run, config, {}});
  if (violation) config::ThrowViolation("scenario", *violation);
  return config;
}

NavState LaneOfNav(const Navigation<Pack>& all, int lane) {
  NavState nav;
  nav.stamp = OfLane(all.stamp, lane);
  nav.p_WB = Lane(all.p_WB, lane);
  nav.v_WB_B = Lane(all.v_WB_B, lane);
  nav.w_WB_B = Lane(all.w_WB_B, lane);
  for (int k = 0; k < 4; ++k) nav.q_WB[k] = Lane(all.q_WB[k], lane);
  nav.position_std_m = Lane(all.position_std_m, lane);
  nav.heading_std_rad = Lane(all.heading_std_rad, lane);
  nav.fix_stamp = OfLane(all.fix_stamp, lane);
  nav.p_WF = Lane(all.p_WF, lane);
  nav.fix_std_m = Lane(all.fix_std_m, lane);
  return nav;
}

}  // namespace

World::World(const WorldConfig& config, const RunConfig& run, const NavigationConfig& stated)
    : dt_s_(run.time.dt_s),
      dt_ns_(run.step_period()),
      current_(Valid(config, run).current),
      v_WC_(Broadcast({config.current.velocity_mps[0], config.current.velocity_mps[1],
                       config.current.velocity_mps[2]})),
      reset_(config.reset),
      depths_(config.sea),
      sensing_(config.sensing),
      kinds_(config.vehicle, run.agents),
      motion_(TargetMotions().Make(config.target.motion, config.target.motions,
                                   {config.target, WallOf(config.workspace, config.sea), dt_s_,
                                    config.workspace.half_extent_m})),
      sensor_(TargetSensors().Make(config.sensing.sensor, config.sensing.sensors, config.sensing)),
      navigation_(NavigationSystems().Make(config.navigation.kind, config.navigation.kinds,
                                           {config.navigation, run.agents, run.time.dt_s, stated})),
      perfect_(navigation_->perfect()),
      separations_(run.agents, 2.0 * config.vehicle.radius_m),
      contacts_(config.contact, run.agents, config.vehicle.radius_m),
      disturbance_(config.disturbance, run.agents, dt_s_),
      walls_(config.workspace),
      sea_(config.sea, run.agents, config.workspace.half_extent_m),
      open_(config.sea.open),
      vehicles_(static_cast<size_t>(run.agents)),
      targets_(static_cast<size_t>(config.target.count)),
      internal_(vehicles_.size() * kinds_.internal_size(), Pack(0.0)),
      commands_(vehicles_.size() * kWrenchSize, Pack(0.0)),
      start_{std::vector<Vec3<double>>(vehicles_.size()),
             std::vector<TargetState<double>>(targets_.size())} {
  for (auto& v : vehicles_) {
    v.trig = TrigOf(v.rpy);
    v.R_WB = RotationOf(v.trig);
  }
}

World::~World() = default;
World::World(World&&) noexcept = default;

void World::Step(const std::vector<Pack>& commands) {
  const size_t inputs = kinds_.command_size(), internals = kinds_.internal_size();
  assert(commands.size() == vehicles_.size() * inputs);
  contacts_.Update(vehicles_, separations_);
  disturbance_.Advance(clocks_);
  const Pack time_s = current_.uniform() ? Pack(0.0) : Time();
  for (size_t i = 0; i < vehicles_.size(); ++i) {
    const int id = static_cast<int>(i);
    if (!current_.uniform()) v_WC_ = current_.At(vehicles_[i].p_WB.z, time_s);
    kinds_[id].Step(commands.data() + i * inputs,
                    {v_WC_, contacts_.force(id), disturbance_.wrench(id)}, dt_s_, &vehicles_[i],
                    internal_.data() + i * internals);
    if (open_) {
      sea_.Apply(id, &vehicles_[i]);
    } else {
      walls_.Apply(&vehicles_[i]);
    }
  }
  motion_->Step(clocks_, vehicles_, &targets_);
  if (open_) sea_.Apply(&targets_);
  for (EpisodeClock& clock : clocks_) ++clock.step;
  if (!perfect_) Navigate();
  separations_.Measure(vehicles_);
}

void World::Navigate() {
  const Pack time_s = current_.uniform() ? Pack(0.0) : Time();
  for (size_t i = 0; i < vehicles_.size(); ++i) {
    if (!current_.uniform()) v_WC_ = current_.At(vehicles_[i].p_WB.z, time_s);
    navigation_->Step(static_cast<int>(i), clocks_, vehicles_[i], v_WC_, sea_.terrain());
  }
}

void World::Step(const std::vector<Wrench<Pack>>& tau) {
  if (kinds_.command_size() != kWrenchSize) {
    throw UserError(
        "vehicle.model: these vehicles take neither force and moment, nor do they have an "
        "autopilot; autopilots are registered for " +
        JoinNames(Autopilots().Names()));
  }
  assert(tau.size() == vehicles_.size());
  Pack* c = commands_.data();
  for (const Wrench<Pack>& t : tau) {
    for (const Pack* x :
         {&t.force.x, &t.force.y, &t.force.z, &t.moment.x, &t.moment.y, &t.moment.z}) {
      *c++ = *x;
    }
  }
  Step(commands_);
}

/// Time since the start of each lane's episode [s].
Pack World::Time() const {
  Pack time_s(0.0);
  for (int lane = 0; lane < kLanes; ++lane) SetLane(&time_s, lane, dt_s_ * step(lane));
  return time_s;
}

void World::CheckFinite() const {
  Pack all(0.0);
  for (const VehicleState<Pack>& v : vehicles_) {
    all += NonFiniteness(v.p_WB) + NonFiniteness(v.v_WB_B) + NonFiniteness(v.w_WB_B);
  }
  if (!Any(!(all == Pack(0.0)))) return;
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int i = 0; i < agents(); ++i) {
      const VehicleState<Pack>& v = vehicle(i);
      if (Finite(Lane(v.p_WB, lane)) && Finite(Lane(v.v_WB_B, lane)) &&
          Finite(Lane(v.w_WB_B, lane))) {
        continue;
      }
      throw UserError("the state of AUV " + std::to_string(i) + " is not finite after " +
                      std::to_string(step(lane)) + " physics steps of the episode with seed " +
                      std::to_string(seed(lane)) + ": " + kUnstableHint);
    }
  }
}

void World::StartLane(int lane, std::uint64_t seed, std::uint32_t episode, const Start& start) {
  clocks_[static_cast<size_t>(lane)] = {seed, episode, 0};
  const double upright[4] = {1.0, 0.0, 0.0, 0.0};
  const EulerTrig<double> level{0.0, 1.0, 0.0, 1.0, 0.0, 1.0};
  const Mat3<double> R_WB = RotationOf(level);
  for (size_t i = 0; i < vehicles_.size(); ++i) {
    SetState(&vehicles_[i], lane, start.p_WB[i], upright, level, R_WB, {}, {});
    if (!perfect_) {
      navigation_->Reset(lane, static_cast<int>(i), clock(lane), vehicles_[i]);
    }
  }
  for (Pack& x : internal_) SetLane(&x, lane, 0.0);
  for (size_t k = 0; k < targets_.size(); ++k) {
    SetLane(&targets_[k].p_WT, lane, start.targets[k].p_WT);
    SetLane(&targets_[k].v_WT, lane, start.targets[k].v_WT);
  }
  motion_->Reset(lane);
  sea_.Reset(lane);
  current_.Reset(lane, seed, episode);
  separations_.Measure(vehicles_);
}

void World::Reset(int lane, std::uint64_t seed, std::uint32_t episode, ResetStage stage) {
  if (open_) {
    DrawSeaStart(reset_, depths_, sea_.scape(), stage, seed, episode, &start_);
  } else {
    DrawStart(reset_, stage, seed, episode, &start_);
  }
  StartLane(lane, seed, episode, start_);
}

void World::RequireWater(const std::string& name, const Vec3<double>& p) const {
  const bool bottom = sea_.scape().Altitude(p) < 0.0, obstacle = sea_.scape().Clearance(p) < 0.0;
  if (!bottom && !obstacle && p.z <= 0.0) return;
  throw UserError(name + " would start " +
                  (bottom     ? "inside the bottom"
                   : obstacle ? "inside an obstacle"
                              : "above the surface") +
                  ", at x " + std::to_string(p.x) + ", y " + std::to_string(p.y) + ", z " +
                  std::to_string(p.z) + " m");
}

void World::Place(int lane, const std::vector<Vec3<double>>& p_WB,
                  const std::vector<Vec3<double>>& p_WT, const std::vector<Vec3<double>>& v_WT) {
  assert(static_cast<int>(p_WB.size()) == agents());
  assert(static_cast<int>(p_WT.size()) == targets() && p_WT.size() == v_WT.size());
  for (std::size_t i = 0; open_ && i < p_WB.size(); ++i) {
    RequireWater("AUV " + std::to_string(i), p_WB[i]);
  }
  for (std::size_t k = 0; open_ && k < p_WT.size(); ++k) {
    RequireWater("target " + std::to_string(k), p_WT[k]);
  }
  start_.p_WB = p_WB;
  for (size_t k = 0; k < p_WT.size(); ++k) start_.targets[k] = {p_WT[k], v_WT[k]};
  StartLane(lane, 0, 0, start_);
}

Navigation<Pack> World::TrueNav(int i) const {
  const VehicleState<Pack>& v = vehicle(i);
  Navigation<Pack> nav;
  for (int lane = 0; lane < kLanes; ++lane) nav.stamp[static_cast<size_t>(lane)] = time(lane);
  nav.p_WB = v.p_WB;
  nav.v_WB_B = v.v_WB_B;
  nav.w_WB_B = v.w_WB_B;
  kinds_[i].Orientation(v, &nav.q_WB);
  return nav;
}

Navigation<Pack> World::Nav(int i) const {
  Navigation<Pack> nav = TrueNav(i);
  if (!perfect_) navigation_->Believe(i, &nav);
  return nav;
}

NavState World::Nav(int lane, int i) const { return LaneOfNav(Nav(i), lane); }

NavState World::Truth(int lane, int i) const { return LaneOfNav(TrueNav(i), lane); }

bool World::Sense(int lane, int i, int k, Detection* out) const {
  if (open_ && !sea_.scape().clear() &&
      !sea_.scape().Sees(Lane(vehicle(i).p_WB, lane), Lane(target(k).p_WT, lane))) {
    return false;
  }
  const auto pair = static_cast<std::uint32_t>(i * targets() + k);
  Observer observer;
  if (perfect_) {
    observer.p_WO = Lane(vehicle(i).p_WB, lane);
  } else {
    observer = navigation_->At(lane, i);
  }
  return sensor_->Sense({lane, clock(lane), dt_s_ * step(lane), time(lane), k, pair, vehicle(i),
                         target(k), observer, !perfect_},
                        out);
}

void World::SenseUnlabelled(int lane, int i, UnlabelledLook* look) const {
  for (int k = 0; k < targets(); ++k) {
    Detection detection;
    if (!Sense(lane, i, k, &detection)) continue;
    RemoveLabel(&detection);
    look->push_back(detection);
  }
  std::sort(look->begin(), look->end(), MeasuresLess);
}

Cue World::InitialCue(int lane, int i, int k) const {
  (void)i;
  return DrawCue(sensing_, clock(lane), k, Lane(target(k).p_WT, lane));
}

}  // namespace stg::dynamics

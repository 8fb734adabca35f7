#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "auv_dynamics/control/control.hpp"
#include "physics.hpp"

namespace stg::dynamics {
namespace {

/// All numbers of one world in one lane that a caller may read.
using Record = std::vector<double>;

void Append(const Vec3<double>& v, Record* out) { out->insert(out->end(), {v.x, v.y, v.z}); }

void Snapshot(const World& world, int lane, Record* out) {
  for (int i = 0; i < world.agents(); ++i) {
    const NavState nav = world.Nav(lane, i);
    Append(nav.p_WB, out);
    out->insert(out->end(), nav.q_WB, nav.q_WB + 4);
    Append(nav.v_WB_B, out);
    Append(nav.w_WB_B, out);
    Append(Lane(world.vehicle(i).v_WB, lane), out);
    Append(Lane(RpyOf(world.vehicle(i).trig), lane), out);
    Detection detection;
    out->push_back(world.Sense(lane, i, 0, &detection) ? 1.0 : 0.0);
    Append(detection.p_WT, out);
    Append(world.InitialCue(lane, i, 0).p_WT, out);
  }
  Append(Lane(world.target(0).p_WT, lane), out);
  Append(Lane(world.target(0).v_WT, lane), out);
  out->push_back(Lane(world.colliding_pairs(), lane));
  out->push_back(Lane(world.smallest_separation(), lane));
  out->push_back(static_cast<double>(world.time(lane)));
}

/// Command that world `id` gives vehicle i at step k.
Wrench<double> Command(int id, int i, int k) {
  std::mt19937_64 random(static_cast<std::uint64_t>(1000 * (k / 20) + 10 * id + i));
  return {RandomVector(&random, 40.0), RandomVector(&random, 6.0)};
}

constexpr int kSteps = 300;

/// Episode number of world `id` at step k: worlds restart at different steps.
int EpisodeOf(int id, int k) { return k / (70 + 10 * id); }

void StartIfDue(World* world, int lane, int id, int k) {
  if (k > 0 && EpisodeOf(id, k) == EpisodeOf(id, k - 1)) return;
  const auto stage = static_cast<ResetStage>((id + EpisodeOf(id, k)) % 3);
  world->Reset(lane, static_cast<std::uint64_t>(40 + id),
               static_cast<std::uint32_t>(EpisodeOf(id, k)), stage);
}

/// Runs the given worlds side by side, world ids[l] in lane l; records each.
std::vector<Record> RunTogether(const WorldScenario& scenario, const std::vector<int>& ids) {
  World world(scenario);
  std::vector<Record> records(ids.size());
  std::vector<Wrench<Pack>> tau = NoForce(scenario.run.agents);
  for (int k = 0; k < kSteps; ++k) {
    for (size_t l = 0; l < ids.size(); ++l) {
      const int lane = static_cast<int>(l);
      StartIfDue(&world, lane, ids[l], k);
      for (int i = 0; i < scenario.run.agents; ++i) {
        const Wrench<double> command = Command(ids[l], i, k);
        SetLane(&tau[static_cast<size_t>(i)].force, lane, command.force);
        SetLane(&tau[static_cast<size_t>(i)].moment, lane, command.moment);
      }
    }
    world.Step(tau);
    for (size_t l = 0; l < ids.size(); ++l) Snapshot(world, static_cast<int>(l), &records[l]);
  }
  return records;
}

bool SameBits(const Record& a, const Record& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(Lanes, EachLaneEqualsTheSameWorldAloneBitForBit) {
  for (const Integrator integrator : {Integrator::kRk4, Integrator::kSemiImplicit}) {
    for (const std::string motion :
         {"constant_velocity", "coordinated_turn", "legs", "random_waypoint", "evasive"}) {
      WorldScenario scenario = QuietScenario(4);
      scenario.world.vehicle.integrator = integrator;
      scenario.world.vehicle.float32_tau = motion == "evasive";
      if (motion == "coordinated_turn") scenario.world.vehicle.r_BG_m = {0.0, 0.01, -0.02};
      scenario.world.target.motion = motion;
      scenario.world.current.velocity_mps = {0.02, -0.03, 0.01};
      scenario.world.disturbance = {2.0, 0.2, 1.0};
      scenario.world.sensing = {"position", 0.45, 0.01, 0.8, 0.2, 1.0, 0.05};
      std::vector<int> ids;
      for (int l = 0; l < kLanes; ++l) ids.push_back(l);
      const std::vector<Record> together = RunTogether(scenario, ids);
      for (const int id : ids) {
        const Record alone = RunTogether(scenario, {id})[0];
        EXPECT_TRUE(SameBits(together[static_cast<size_t>(id)], alone)) << "lane " << id;
      }
      ASSERT_FALSE(SameBits(together[0], together[1]));
    }
  }
}

TEST(Lanes, OrderOfTheLanesDoesNotMatter) {
  std::vector<int> forward, backward;
  for (int l = 0; l < kLanes; ++l) {
    forward.push_back(l);
    backward.insert(backward.begin(), l);
  }
  const WorldScenario scenario = QuietScenario(3);
  const std::vector<Record> a = RunTogether(scenario, forward), b = RunTogether(scenario, backward);
  for (size_t l = 0; l < a.size(); ++l) EXPECT_TRUE(SameBits(a[l], b[a.size() - 1 - l]));
}

TEST(Lanes, ScalarIntegratorEqualsTheWorldBitForBit) {
  // A program that steps one vehicle with doubles gets the same numbers as the World.
  for (const Integrator integrator : {Integrator::kRk4, Integrator::kSemiImplicit}) {
    WorldScenario scenario = QuietScenario(1);
    scenario.world.vehicle.integrator = integrator;
    scenario.world.workspace.half_extent_m = 100.0;
    scenario.world.current.velocity_mps = {0.02, -0.03, 0.01};
    World world(scenario);
    world.Place(0, {{0.0, 0.0, 0.0}}, {{0.5, 0.0, 0.0}}, {{0.0, 0.0, 0.0}});
    const VehicleModel model(scenario.world.vehicle);
    VehicleState<double> s = AtAttitude({});
    std::vector<Wrench<Pack>> tau = NoForce(1);
    for (int k = 0; k < 500; ++k) {
      const Wrench<double> command = Command(3, 0, k);
      tau[0] = {Broadcast(command.force), Broadcast(command.moment)};
      world.Step(tau);
      Advance(model, model.Limit(command), {0.02, -0.03, 0.01}, 0.1, 1, &s);
    }
    const NavState nav = world.Nav(0, 0);
    EXPECT_EQ(Norm(nav.p_WB - s.p_WB), 0.0);
    EXPECT_EQ(Norm(nav.v_WB_B - s.v_WB_B), 0.0);
    EXPECT_EQ(Norm(nav.w_WB_B - s.w_WB_B), 0.0);
  }
}

TEST(Lanes, ControllerOfDoublesEqualsThatOfPacksBitForBit) {
  std::mt19937_64 random(5);
  const VehicleConfig v;
  for (const HeadingMode heading : {HeadingMode::kFree, HeadingMode::kAlongVelocity}) {
    ControlConfig c;
    c.heading = heading;
    for (int n = 0; n < 200; ++n) {
      Vec3<Pack> rpy, wanted, speed, rates;
      for (int l = 0; l < kLanes; ++l) {
        SetLane(&rpy, l, RandomVector(&random, 1.5));
        SetLane(&wanted, l, RandomVector(&random, 0.5));
        SetLane(&speed, l, RandomVector(&random, 0.5));
        SetLane(&rates, l, RandomVector(&random, 1.0));
      }
      Pack packs[6];
      VelocityController(c, v, wanted, RotationOf(TrigOf(rpy)), speed, rpy, rates, packs);
      for (int l = 0; l < kLanes; ++l) {
        double fraction[6];
        const Vec3<double> a = Lane(rpy, l);
        VelocityController(c, v, Lane(wanted, l), RotationOf(TrigOf(a)), Lane(speed, l), a,
                           Lane(rates, l), fraction);
        for (int k = 0; k < 6; ++k) EXPECT_EQ(Lane(packs[k], l), fraction[k]);
      }
    }
  }
}

}  // namespace
}  // namespace stg::dynamics

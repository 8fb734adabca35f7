#include "auv_dynamics/world/starts.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/error.hpp"
#include "auv_common/numbers/attitude.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::dynamics {
namespace {

Vec3<double> UniformDirection(Random* random) {
  const double z = random->Uniform(-1.0, 1.0);
  const double angle = random->Uniform(0.0, 2.0 * kPi);
  const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {r * std::cos(angle), r * std::sin(angle), z};
}

bool Inside(const Vec3<double>& p, double half_extent) {
  return std::abs(p.x) <= half_extent && std::abs(p.y) <= half_extent &&
         std::abs(p.z) <= half_extent;
}

/// Smallest distance of vehicles and targets from the bottom and obstacles at the start [m].
constexpr double kClearOfAll_m = 5.0;
/// Smallest distance of vehicles from obstacles at the start [m]. A torpedo that starts towards an
/// obstacle needs its turning circle of 25 m to pass it.
constexpr double kRoomToTurn_m = 30.0;

Vec3<double> LevelDirection(Random* random) {
  const double angle = random->Uniform(0.0, 2.0 * kPi);
  return {std::cos(angle), std::sin(angle), 0.0};
}

/// Places the vehicles on a level line, min_separation_m apart. The middle of the line has a random
/// distance and direction from the first target.
std::vector<Vec3<double>> DrawLine(const ResetConfig& config, const ResetStageConfig& stage,
                                   const Start& start, Random* random) {
  const double distance = random->Uniform(stage.auv_distance_m.lo, stage.auv_distance_m.hi);
  const Vec3<double> middle = start.targets.front().p_WT + LevelDirection(random) * distance;
  const Vec3<double> along = LevelDirection(random) * config.min_separation_m;
  std::vector<Vec3<double>> line;
  const double half = 0.5 * (static_cast<double>(start.p_WB.size()) - 1.0);
  for (std::size_t i = 0; i < start.p_WB.size(); ++i) {
    line.push_back(middle + along * (static_cast<double>(i) - half));
  }
  return line;
}

/// Draws a position for each vehicle until it lies in the region and far enough from the previous
/// ones.
/// @param draw  random, position of the vehicle's target -> a position
/// @param clear true if a position is in free water
template <class Draw, class Clear>
void PlaceVehicles(const ResetConfig& config, Random* random, const Draw& draw, const Clear& clear,
                   Start* start) {
  auto& p_WB = start->p_WB;
  for (size_t i = 0; i < p_WB.size(); ++i) {
    const Vec3<double>& p_WT = start->targets[i % start->targets.size()].p_WT;
    bool placed = false;
    // Rejection sampling. Validation rejects scenarios that are too crowded for it.
    for (int attempt = 0; attempt < 100000 && !placed; ++attempt) {
      p_WB[i] = draw(random, p_WT);
      placed = Inside(p_WB[i], config.start_half_extent_m) && clear(p_WB[i]);
      for (size_t j = 0; j < i && placed; ++j) {
        placed = Norm(p_WB[i] - p_WB[j]) >= config.min_separation_m;
      }
    }
    if (!placed) {
      throw UserError("reset: no room for " + std::to_string(p_WB.size()) +
                      " vehicles at reset.min_separation_m, clear of walls, bottom and obstacles");
    }
  }
}

}  // namespace

void DrawStart(const ResetConfig& config, ResetStage stage, std::uint64_t seed,
               std::uint32_t episode, Start* start) {
  const ResetStageConfig& r = config.stages[static_cast<size_t>(stage)];
  Random random(seed, Stream::kReset, episode, 0, 0);
  for (auto& target : start->targets) {
    const double radius = random.Uniform(r.target_radius_m.lo, r.target_radius_m.hi);
    target.p_WT = UniformDirection(&random) * radius;
    const double speed = random.Uniform(r.target_speed_mps.lo, r.target_speed_mps.hi);
    target.v_WT = UniformDirection(&random) * speed;
  }
  PlaceVehicles(
      config, &random,
      [&r](Random* draw, const Vec3<double>& p_WT) {
        const double d = draw->Uniform(r.auv_distance_m.lo, r.auv_distance_m.hi);
        return p_WT + UniformDirection(draw) * d;
      },
      [](const Vec3<double>&) { return true; }, start);
}

void DrawSeaStart(const ResetConfig& config, const SeaConfig& sea, const Seascape& scape,
                  ResetStage stage, std::uint64_t seed, std::uint32_t episode, Start* start) {
  const ResetStageConfig& r = config.stages[static_cast<size_t>(stage)];
  Random random(seed, Stream::kReset, episode, 0, 0);
  const auto at_depth = [](Vec3<double> p, Random* draw, const config::Interval& depth_m) {
    p.z = -draw->Uniform(depth_m.lo, depth_m.hi);
    return p;
  };
  const auto clear_of = [&scape](const Vec3<double>& p, double obstacles_m) {
    return scape.Altitude(p) > kClearOfAll_m && scape.Clearance(p) > obstacles_m;
  };
  const auto clear = [&](const Vec3<double>& p) { return clear_of(p, kRoomToTurn_m); };
  for (auto& target : start->targets) {
    bool placed = false;
    for (int attempt = 0; attempt < 1000 && !placed; ++attempt) {
      const double radius = random.Uniform(r.target_radius_m.lo, r.target_radius_m.hi);
      target.p_WT = at_depth(LevelDirection(&random) * radius, &random, sea.target_depth_m);
      placed = clear_of(target.p_WT, kClearOfAll_m);
    }
    if (!placed) {
      throw UserError(
          "reset: every start of a target lies in the bottom or an obstacle; the water is " +
          std::to_string(scape.Altitude({})) +
          " m deep at the world's origin; see sea.target_depth_m, sea.latitude_deg, "
          "sea.longitude_deg");
    }
    const double speed = random.Uniform(r.target_speed_mps.lo, r.target_speed_mps.hi);
    target.v_WT = LevelDirection(&random) * speed;
  }
  if (config.deploy == Deploy::kPoint) {
    for (int attempt = 0; attempt < 1000; ++attempt) {
      start->p_WB = DrawLine(config, r, *start, &random);
      bool placed = true;
      for (Vec3<double>& p_WB : start->p_WB) {
        p_WB = at_depth(p_WB, &random, sea.auv_depth_m);
        placed = placed && Inside(p_WB, config.start_half_extent_m) && clear(p_WB);
      }
      if (placed) return;
    }
    throw UserError(
        "reset: no room for a line of vehicles at reset.stages.*.auv_distance_m from the first "
        "target, clear of walls, bottom and obstacles");
  }
  PlaceVehicles(
      config, &random,
      [&](Random* draw, const Vec3<double>& p_WT) {
        if (config.deploy == Deploy::kArea) {
          const double half = config.start_half_extent_m;
          const double x = draw->Uniform(-half, half), y = draw->Uniform(-half, half);
          return at_depth({x, y, 0.0}, draw, sea.auv_depth_m);
        }
        const double d = draw->Uniform(r.auv_distance_m.lo, r.auv_distance_m.hi);
        return at_depth(p_WT + LevelDirection(draw) * d, draw, sea.auv_depth_m);
      },
      clear, start);
}

}  // namespace stg::dynamics

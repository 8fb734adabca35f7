#include "stg_env/record/scene.hpp"

#include <cmath>

#include "auv_common/error.hpp"
#include "auv_dynamics/terrain/seascape.hpp"

namespace stg::env {
namespace {

constexpr int kCells = 64;  // cells of the drawn bottom along each side

/// Heights of the bottom on a grid, rows from south to north. Whole decimetres are enough for a
/// picture.
nlohmann::json BottomOf(const dynamics::Seascape& sea, double half_m) {
  const double step = 2.0 * half_m / kCells;
  nlohmann::json heights = nlohmann::json::array();
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      heights.push_back(
          std::round(10.0 * sea.terrain.Height(i * step - half_m, j * step - half_m)) / 10.0);
    }
  }
  return {{"nodes", kCells + 1}, {"half_extent_m", half_m}, {"heights_m", heights}};
}

nlohmann::json ObstaclesOf(const dynamics::Seascape& sea) {
  nlohmann::json list = nlohmann::json::array();
  for (const dynamics::Obstacle& o : sea.obstacles) {
    list.push_back({{"kind", o.kind == dynamics::Obstacle::Kind::kSphere ? "sphere" : "cylinder"},
                    {"p_W_m", {o.p_W.x, o.p_W.y, o.p_W.z}},
                    {"radius_m", o.radius_m},
                    {"height_m", o.height_m}});
  }
  return list;
}

}  // namespace

nlohmann::json SceneOf(const task::JudgeConfig& s, const acoustics::ChannelConfig& channel) {
  nlohmann::json scene = {{"scenario", s.run.name},
                          {"agents", s.run.agents},
                          {"targets", s.world.target.count},
                          {"decision_s", s.run.decision_dt_s()},
                          {"half_extent_m", s.world.workspace.half_extent_m},
                          {"open", s.world.sea.open},
                          {"band_m", {s.reward.band_m.lo, s.reward.band_m.hi}},
                          {"lost_distance_m", s.agent.task.lost_distance_m},
                          {"sensing_range_m", s.world.sensing.range_m},
                          {"radius_m", s.world.vehicle.radius_m},
                          {"channel", channel.model},
                          {"access", channel.access}};
  if (!s.world.sea.open) return scene;
  try {
    const dynamics::Seascape sea(s.world.sea, s.world.workspace.half_extent_m);
    scene["bottom"] = BottomOf(sea, s.world.workspace.half_extent_m);
    scene["obstacles"] = ObstaclesOf(sea);
  } catch (const UserError& e) {
    scene["notes"] = {std::string("The bottom of the sea is not shown: ") + e.what()};
  }
  return scene;
}

}  // namespace stg::env

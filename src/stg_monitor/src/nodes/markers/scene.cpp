#include "scene.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

namespace stg::nodes {

namespace {

/// Reads rows of `size` finite numbers. Other rows are left out.
void ReadRows(const YAML::Node& list, std::size_t size, std::vector<std::vector<double>>* rows) {
  for (const YAML::Node& row : list) {
    std::vector<double> numbers = row.as<std::vector<double>>(std::vector<double>());
    bool finite = numbers.size() == size;
    for (const double x : numbers) finite = finite && std::isfinite(x);
    if (finite) rows->push_back(std::move(numbers));
  }
}

/// Half extent of the overview at first. In open water it covers a target and the start positions
/// of the AUVs; otherwise it covers the whole workspace. view.py sets the camera for it.
double ShownHalfExtent(const YAML::Node& root, const SceneConfig& scene) {
  const YAML::Node reset = root["reset"];
  const bool anywhere = !reset || reset["deploy"].as<std::string>("around") == "area";
  const int targets = root["target"] ? root["target"]["count"].as<int>(1) : 1;
  if (!scene.sea.open || anywhere || targets != 1 || !reset["stages"]) return scene.half_extent_m;
  const YAML::Node stage = reset["stages"][reset["stage"].as<std::string>("")];
  if (!stage || !stage["auv_distance_m"]) return scene.half_extent_m;
  const double farthest = stage["auv_distance_m"][1].as<double>(0.0);
  if (!(farthest > 0.0)) return scene.half_extent_m;
  return std::min(scene.half_extent_m, farthest + scene.band_hi_m);
}

}  // namespace

SceneConfig ReadScene(const std::string& yaml) {
  const YAML::Node root = YAML::Load(yaml);
  SceneConfig scene;
  const auto number = [&](const char* group, const char* key, double fallback) {
    const double value = root[group] ? root[group][key].as<double>(fallback) : fallback;
    return std::isfinite(value) ? value : fallback;
  };
  const auto positive = [&](const char* group, const char* key, double fallback) {
    const double value = number(group, key, fallback);
    return value > 0.0 ? value : fallback;
  };
  scene.name = root["name"].as<std::string>("");
  scene.half_extent_m = positive("workspace", "half_extent_m", scene.half_extent_m);
  scene.sensing_range_m = positive("sensing", "range_m", scene.sensing_range_m);
  scene.radius_m = positive("vehicle", "radius_m", scene.radius_m);
  scene.decision_s = positive("time", "dt_s", 0.1) * positive("time", "decision_steps", 1.0);
  scene.desired_distance_m = positive("task", "desired_distance_m", scene.desired_distance_m);
  scene.lost_std_m = positive("track", "lost_std_m", scene.lost_std_m);
  if (const YAML::Node stations = root["stations"]) {
    const YAML::Node beacons = stations["beacons"];
    if (beacons) scene.beacons = static_cast<int>(beacons.size());
  }
  if (root["reward"] && root["reward"]["band_m"]) {
    scene.band_lo_m = root["reward"]["band_m"][0].as<double>(scene.band_lo_m);
    scene.band_hi_m = root["reward"]["band_m"][1].as<double>(scene.band_hi_m);
  }
  if (const YAML::Node sea = root["sea"]) {
    scene.sea.open = sea["open"].as<bool>(false);
    scene.sea.terrain = sea["terrain"].as<std::string>("flat");
    scene.sea.bottom_m = positive("sea", "bottom_m", scene.sea.bottom_m);
    scene.sea.latitude_deg = number("sea", "latitude_deg", 0.0);
    scene.sea.longitude_deg = number("sea", "longitude_deg", 0.0);
    ReadRows(sea["spheres"], 4, &scene.sea.spheres);
    ReadRows(sea["cylinders"], 5, &scene.sea.cylinders);
  }
  scene.shown_half_extent_m = ShownHalfExtent(root, scene);
  return scene;
}

}  // namespace stg::nodes

#include "terrain_markers.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <limits>

#include "shapes/marker_list.hpp"

namespace stg::nodes {
namespace {

using visualization_msgs::MarkerArray;

constexpr int kCells = 96;            // cells of the drawn surface along each side
constexpr int kLineEvery = 8;         // cells between two lines drawn on it
constexpr int kScaleSteps = 6;        // number of colours in the scale
constexpr double kLeastSpan_m = 1.0;  // a bottom with less span is flat and has one colour
constexpr double kFlatShare = 0.35;

/// Colour from the deepest point (0) through blues and greens to the shallowest (1); land is brown.
/// All colours are dark enough for white text in front of them.
std_msgs::ColorRGBA DepthColor(double share, bool land) {
  struct Stop {
    double at, r, g, b;
  };
  static constexpr Stop kStops[] = {{0.00, 0.06, 0.09, 0.30},
                                    {0.30, 0.09, 0.25, 0.55},
                                    {0.60, 0.10, 0.42, 0.58},
                                    {0.85, 0.22, 0.52, 0.46},
                                    {1.00, 0.50, 0.52, 0.30}};
  if (land) return Color(0.45, 0.36, 0.22);
  const double s = std::clamp(share, 0.0, 1.0);
  std::size_t k = 1;
  while (k + 1 < std::size(kStops) && kStops[k].at < s) ++k;
  const Stop &a = kStops[k - 1], &b = kStops[k];
  const double t = (s - a.at) / (b.at - a.at);
  return Color(a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b));
}

class TerrainBuilder : private MarkerList {
 public:
  TerrainBuilder(const SceneConfig& scene, const dynamics::Seascape& sea)
      : sea_(sea), half_(scene.half_extent_m), step_(2.0 * half_ / kCells) {
    heights_.reserve((kCells + 1) * (kCells + 1));
    lowest_ = std::numeric_limits<double>::infinity();
    highest_ = -lowest_;
    for (int j = 0; j <= kCells; ++j) {
      for (int i = 0; i <= kCells; ++i) {
        const double z = sea.terrain.Height(i * step_ - half_, j * step_ - half_);
        lowest_ = std::min(lowest_, z);
        highest_ = std::max(highest_, std::min(z, 0.0));
        heights_.push_back(z);
      }
    }
  }

  MarkerArray Build() {
    Surface();
    Grid();
    Frame();
    Scale();
    Obstacles();
    return std::move(array_);
  }

 private:
  Point Node(int i, int j, double lift = 0.0) const {
    return At(i * step_ - half_, j * step_ - half_,
              heights_[static_cast<std::size_t>(j * (kCells + 1) + i)] + lift);
  }
  ColorRGBA ColorAt(double z) const {
    const bool flat = highest_ - lowest_ < kLeastSpan_m;
    return DepthColor(flat ? kFlatShare : (z - lowest_) / (highest_ - lowest_), z > 0.0);
  }

  void Surface() {
    Marker m = New("terrain", 0, Marker::TRIANGLE_LIST, Color(1, 1, 1));
    m.scale.x = m.scale.y = m.scale.z = 1.0;
    const auto vertex = [&](int i, int j) {
      m.points.push_back(Node(i, j));
      m.colors.push_back(ColorAt(m.points.back().z));
    };
    for (int j = 0; j < kCells; ++j) {
      for (int i = 0; i < kCells; ++i) {
        vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1);
        vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1);
      }
    }
    array_.markers.push_back(std::move(m));
  }

  /// Lines on the bottom that make its slopes visible.
  void Grid() {
    Marker m =
        Lines("terrain_grid", 0, Marker::LINE_LIST, 0.0015 * half_, Color(0.75, 0.85, 0.95, 0.25));
    const double lift = 0.001 * half_;
    for (int line = 0; line <= kCells; line += kLineEvery) {
      for (int k = 0; k < kCells; ++k) {
        m.points.insert(m.points.end(), {Node(line, k, lift), Node(line, k + 1, lift),
                                         Node(k, line, lift), Node(k + 1, line, lift)});
      }
    }
    Add(std::move(m));
  }

  void Frame() {
    Marker m =
        Lines("sea_surface", 0, Marker::LINE_STRIP, 0.003 * half_, Color(0.55, 0.75, 0.95, 0.7));
    for (const auto& [x, y] :
         {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}, {-1.0, -1.0}}) {
      m.points.push_back(At(x * half_, y * half_, 0.0));
    }
    Add(std::move(m));
  }

  /// Colour patches with their depths, upright at the western corner.
  void Scale() {
    const double size = 0.06 * half_;
    const bool flat = highest_ - lowest_ < kLeastSpan_m;
    const int steps = flat ? 1 : kScaleSteps;
    for (int k = 0; k < steps; ++k) {
      const double z = flat ? lowest_ : highest_ - (highest_ - lowest_) * k / (steps - 1);
      const Point p = At(0.55 * half_, -1.12 * half_, 0.35 * half_ - 1.5 * size * k);
      Marker patch = New("depth_scale", k, Marker::CUBE, ColorAt(z));
      patch.pose.position = p;
      patch.scale.x = patch.scale.y = patch.scale.z = size;
      Add(std::move(patch));
      char text[32];
      std::snprintf(text, sizeof(text), "%.0f m deep", std::max(0.0, -z));
      Text("depth_label", k, Sum(p, At(0.19 * half_, -0.16 * half_, 0.0)), size, text,
           Color(0.9, 0.95, 1.0));
    }
  }

  void Obstacles() {
    const ColorRGBA color = Color(0.75, 0.45, 0.25, 0.85);
    int id = 0;
    for (const dynamics::Obstacle& o : sea_.obstacles) {
      if (o.kind == dynamics::Obstacle::Kind::kSphere) {
        Sphere("obstacle", id++, At(o.p_W.x, o.p_W.y, o.p_W.z), 2.0 * o.radius_m, color);
        continue;
      }
      Marker m = New("obstacle", id++, Marker::CYLINDER, color);
      m.pose.position = At(o.p_W.x, o.p_W.y, o.p_W.z + 0.5 * o.height_m);
      m.scale.x = m.scale.y = 2.0 * o.radius_m;
      m.scale.z = o.height_m;
      Add(std::move(m));
    }
  }

  const dynamics::Seascape& sea_;
  const double half_, step_;
  double lowest_, highest_;
  std::vector<double> heights_;
};

}  // namespace

MarkerArray BuildTerrain(const SceneConfig& scene, const dynamics::Seascape& sea) {
  return TerrainBuilder(scene, sea).Build();
}

MarkerArray NoTerrain() {
  MarkerArray none;
  none.markers.emplace_back();
  none.markers.back().action = visualization_msgs::Marker::DELETEALL;
  return none;
}

}  // namespace stg::nodes

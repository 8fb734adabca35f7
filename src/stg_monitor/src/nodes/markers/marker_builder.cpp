#include "marker_builder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "parts/belief_markers.hpp"
#include "parts/network_markers.hpp"
#include "shapes/marker_list.hpp"

namespace stg::nodes {
namespace {

using geometry_msgs::Point;
using std_msgs::ColorRGBA;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

class Builder : private MarkerList {
 public:
  Builder(const SwarmView& view, const MarkerStyle& style)
      : view_(view), style_(style), unit_(UnitOf(view, style)), text_(LettersOf(view, style)) {}

  MarkerArray Build() {
    if (style_.whole_workspace) Workspace();
    Targets();
    for (size_t k = 0; k < view_.stations.size(); ++k) {
      if (view_.stations[k]) Station(static_cast<int>(k), *view_.stations[k]);
    }
    for (size_t i = 0; i < view_.vehicles.size(); ++i) Vehicle(static_cast<int>(i));
    Summary();
    AddBeliefMarkers(view_, style_, &array_);
    AddNetworkMarkers(view_, style_, &array_);
    return std::move(array_);
  }

 private:
  void Workspace() {
    const double h = view_.scene.half_extent_m;
    if (!view_.scene.sea.open) Walls(h);
    // A line from each AUV and target to the floor, or to the sea's surface. Without it, depth is
    // hard to see.
    Marker threads = Lines("workspace", 2, Marker::LINE_LIST,
                           0.002 * view_.scene.shown_half_extent_m, Color(0.7, 0.75, 0.8, 0.25));
    const auto thread = [&](const Point& p) {
      threads.points.push_back(p);
      threads.points.push_back(At(p.x, p.y, view_.scene.sea.open ? 0.0 : -h));
    };
    for (const VehicleView& v : view_.vehicles) {
      if (v.seen) thread(v.pose.position);
    }
    for (const MovingTarget& t : view_.targets) {
      if (t.seen) thread(t.position);
    }
    Add(std::move(threads));
  }

  void Walls(double h) {
    Marker walls =
        Lines("workspace", 0, Marker::LINE_LIST, 0.004 * h, Color(0.55, 0.62, 0.72, 0.8));
    for (const double a : {-h, h}) {
      for (const double b : {-h, h}) {
        walls.points.insert(walls.points.end(), {At(-h, a, b), At(h, a, b), At(a, -h, b),
                                                 At(a, h, b), At(a, b, -h), At(a, b, h)});
      }
    }
    Add(std::move(walls));
    Marker floor =
        Lines("workspace", 1, Marker::LINE_LIST, 0.002 * h, Color(0.45, 0.52, 0.62, 0.35));
    for (int k = -3; k <= 3; ++k) {
      const double s = 0.25 * h * k;
      floor.points.insert(floor.points.end(),
                          {At(s, -h, -h), At(s, h, -h), At(-h, s, -h), At(h, s, -h)});
    }
    Add(std::move(floor));
  }

  void Targets() {
    for (size_t k = 0; k < view_.targets.size(); ++k) {
      const MovingTarget& t = view_.targets[k];
      if (!t.seen) continue;
      const int id = static_cast<int>(k);
      const Point& p = t.position;
      const bool point = style_.whole_workspace || view_.scene.sea.open;
      Sphere("target", id, p, point ? 0.5 * unit_ : view_.scene.band_lo_m, Color(1, 0.15, 0.45));
      Marker arrow = New("target_velocity", id, Marker::ARROW, Color(1, 0.15, 0.45, 0.9));
      const double s = view_.scene.sea.open ? 100.0 * view_.scene.decision_s : style_.prediction_s;
      arrow.points = {p, Sum(p, At(s * t.velocity.x, s * t.velocity.y, s * t.velocity.z))};
      arrow.scale.x = 0.06 * unit_;
      arrow.scale.y = 0.2 * unit_;
      arrow.scale.z = 0.3 * unit_;
      Add(std::move(arrow));
      Sphere("tracking_band", 2 * id, p, 2.0 * view_.scene.band_hi_m, Color(0.2, 0.9, 0.4, 0.15));
      Sphere("tracking_band", 2 * id + 1, p, 2.0 * view_.scene.band_lo_m,
             Color(0.9, 0.9, 0.2, 0.15));
      Circle("tracking_ring", id, p, view_.scene.band_hi_m, 0.03 * unit_,
             Color(0.2, 0.9, 0.4, 0.8));
      if (style_.whole_workspace) {
        const double r = view_.scene.sensing_range_m;
        Sphere("sensing_range", id, p, 2.0 * r, Color(0.35, 0.55, 1.0, 0.07));
        Circle("sensing_ring", id, p, r, 0.05 * unit_, Color(0.45, 0.65, 1.0, 0.6));
      }
      Trail("target_trail", id, t.trail, Color(1, 0.15, 0.45), false);
    }
  }

  /// A beacon, or a craft at the surface. Its number is that of its topic.
  void Station(int id, const Point& p) {
    const ColorRGBA colour = Color(0.95, 0.6, 0.1, 0.9);
    Sphere("station", id, p, unit_, colour);
    const char* kind = id < view_.scene.beacons ? "beacon " : "craft ";
    Text("station_label", id, Sum(p, At(0, 0, unit_ + text_)), text_, kind + std::to_string(id),
         colour);
  }

  /// A line along the past positions. Older parts are more transparent.
  void Trail(const char* name, int id, const std::deque<TrailPoint>& trail, ColorRGBA color,
             bool by_phase) {
    Marker m = Lines(name, id, Marker::LINE_STRIP, 0.07 * unit_, Color(1, 1, 1));
    const double reach_s = TrailSecondsOf(view_, style_);
    const double count = static_cast<double>(std::max<size_t>(trail.size(), 1));
    for (size_t k = 0; k < trail.size(); ++k) {
      if (trail[k].time < view_.now - reach_s) continue;
      const double alpha = 0.15 + 0.75 * static_cast<double>(k + 1) / count;
      m.points.push_back(trail[k].position);
      if (by_phase) color = PhaseColor(trail[k].phase);
      color.a = static_cast<float>(alpha);
      m.colors.push_back(color);
    }
    Add(std::move(m));
  }

  /// Distance to the nearest other AUV [m].
  double Nearest(size_t i) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t j = 0; j < view_.vehicles.size(); ++j) {
      const VehicleView& other = view_.vehicles[j];
      if (j == i || !other.seen) continue;
      nearest = std::min(nearest, Distance(other.pose.position, view_.vehicles[i].pose.position));
    }
    return nearest;
  }

  void Vehicle(int id) {
    const VehicleView& v = view_.vehicles[static_cast<size_t>(id)];
    if (!v.seen) return;
    const Point& p = v.pose.position;
    // Enlarged hulls shrink if AUVs come close, but not below their true size.
    const double nearest = Nearest(static_cast<size_t>(id));
    const double full = 2.0 * unit_;
    const double least = std::max(0.4 * full, std::min(full, 2.0 * view_.scene.radius_m));
    const double length = std::clamp(1.6 * nearest, least, full);
    Mesh("hull", id, v.pose, length, "auv_hull.stl", PhaseColor(v.phase));
    Mesh("fittings", id, v.pose, length, "auv_fittings.stl", Color(0.80, 0.83, 0.88));
    Trail("trail", id, v.trail, Color(1, 1, 1), true);
    if (!style_.whole_workspace) {
      Sphere("collision_sphere", id, p, 2.0 * view_.scene.radius_m,
             nearest < 2.0 * view_.scene.radius_m ? Color(1.0, 0.2, 0.2, 0.16)
                                                  : Color(0.8, 0.85, 0.9, 0.07));
    }
    Label(id, v);
  }

  /// Number of AUVs below this one. It is the rank of the label, so that labels in a crowd are
  /// stacked.
  int Below(int id) const {
    const double z = PositionOf(id).z;
    int below = 0;
    for (int j = 0; j < static_cast<int>(view_.vehicles.size()); ++j) {
      if (j == id || !Seen(j)) continue;
      const double other = PositionOf(j).z;
      if (other < z || (other == z && j < id)) ++below;
    }
    return below;
  }

  /// Labels stand on stems in different directions and heights, so they stay apart even if the AUVs
  /// do not.
  void Label(int id, const VehicleView& v) {
    const int count = static_cast<int>(view_.vehicles.size());
    const bool many = count > kManyVehicles;
    const double angle = 2.0 * kPi * (id + 0.5) / count;
    const double arm = 1.4 * unit_;
    const Point& p = v.pose.position;
    const Point end = Sum(p, At(arm * std::cos(angle), arm * std::sin(angle),
                                1.5 * arm + (many ? 0.0 : 1.5 * text_ * Below(id))));
    Marker stem =
        Lines("label_stem", id, Marker::LINE_LIST, 0.025 * unit_, PhaseColor(v.phase, 0.6));
    stem.points = {p, end};
    Add(std::move(stem));
    std::string text = "AUV " + std::to_string(id);
    if (many) {
      text = std::to_string(id) + (v.leader ? "*" : "");
    } else {
      text += std::string(" ") + PhaseName(v.phase) + (v.leader ? ", leads" : "");
      if (v.distance >= 0.0) {
        char number[32];
        std::snprintf(number, sizeof(number), "  %.*f m", Digits(), v.distance);
        text += number;
      }
    }
    Text("label", id, Sum(end, At(0, 0, 0.6 * text_)), text_, text, Color(1, 1, 1, 0.95));
  }

  /// Number of decimals of lengths in texts.
  int Digits() const { return view_.scene.band_hi_m < 1.0 ? 3 : 0; }

  bool Seen(int i) const {
    return i >= 0 && i < static_cast<int>(view_.vehicles.size()) &&
           view_.vehicles[static_cast<size_t>(i)].seen;
  }
  const Point& PositionOf(int i) const {
    return view_.vehicles[static_cast<size_t>(i)].pose.position;
  }

  /// Text about the whole swarm, above the workspace or above target 0.
  void Summary() {
    double distance = 0.0, quality = 0.0, age = 0.0;
    std::uint64_t delivered = 0, dropped = 0;
    int vehicles = 0;
    for (size_t i = 0; i < view_.vehicles.size(); ++i) {
      if (view_.targets.empty() || !view_.vehicles[i].seen) continue;
      const MovingTarget& t = view_.targets[i % view_.targets.size()];
      if (!t.seen) continue;
      distance += Distance(view_.vehicles[i].pose.position, t.position);
      ++vehicles;
    }
    for (const auto& [pair, link] : view_.links) {
      quality += link.quality;
      age += link.age;
      delivered += link.delivered;
      dropped += link.dropped;
    }
    const double links = static_cast<double>(std::max<size_t>(view_.links.size(), 1));
    const double packets = static_cast<double>(std::max<std::uint64_t>(delivered + dropped, 1));
    char lines[2][160];
    std::snprintf(lines[0], sizeof(lines[0]), "%s  episode %u  step %u  t %.1f s",
                  view_.scene.name.c_str(), view_.episode, view_.step, view_.now);
    std::snprintf(lines[1], sizeof(lines[1]),
                  "distance %.*f m  link quality %.2f  age %.2f s  packets lost %.0f %%",
                  Digits() + 1, distance / std::max(vehicles, 1), quality / links, age / links,
                  100.0 * static_cast<double>(dropped) / packets);
    Point top = Sum(Centre(), At(0, 0, 1.25 * view_.scene.shown_half_extent_m));
    double height = 1.4 * text_;
    if (!style_.whole_workspace) {
      if (view_.targets.empty() || !view_.targets[0].seen) return;
      const double above =
          std::max(7.5 * view_.scene.radius_m * style_.vehicle_scale, 1.4 * view_.scene.band_hi_m);
      top = Sum(view_.targets[0].position, At(0, 0, above));
      height = text_;
    }
    for (int k = 0; k < 2; ++k) {
      Text("summary", k, Sum(top, At(0, 0, -1.4 * height * k)), height, lines[k],
           Color(0.95, 0.97, 1));
    }
    if (style_.whole_workspace) Legend();
  }

  /// Centre of the overview.
  Point Centre() const {
    const bool all = view_.scene.shown_half_extent_m >= view_.scene.half_extent_m;
    if (all || view_.targets.empty() || !view_.targets[0].seen) return At(0, 0, 0);
    return view_.targets[0].position;
  }

  void Legend() {
    const double h = view_.scene.shown_half_extent_m;
    const auto line = [&](int k) {
      return Sum(Centre(), At(1.12 * h, -1.12 * h, 0.9 * h - 2.0 * text_ * k));
    };
    for (int k = 0; k < 4; ++k) {
      const auto phase = static_cast<ShownPhase>(k);
      Text("legend", k, line(k), 1.3 * text_, PhaseName(phase), PhaseColor(phase));
    }
    // With a few AUVs, each label has this text.
    if (static_cast<int>(view_.vehicles.size()) <= kManyVehicles) return;
    Text("legend", 4, line(4), 1.3 * text_, "* leads", Color(1, 1, 1, 0.95));
  }

  const SwarmView& view_;
  const MarkerStyle& style_;
  const double unit_;  // drawn radius of a vehicle [m]; all sizes that scale are multiples of it
  const double text_;  // height of letters [m]
};

}  // namespace

MarkerArray BuildMarkers(const SwarmView& view, const MarkerStyle& style) {
  return Builder(view, style).Build();
}

}  // namespace stg::nodes

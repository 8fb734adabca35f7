#include "network_markers.hpp"

#include <auv_msgs/LinkState.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "shapes/marker_list.hpp"

namespace stg::nodes {
namespace {

using auv_msgs::LinkState;
using geometry_msgs::Point;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kSoundSpeed_mps = 1500.0;

class NetworkBuilder : private MarkerList {
 public:
  NetworkBuilder(const SwarmView& view, const MarkerStyle& style)
      : view_(view),
        style_(style),
        unit_(UnitOf(view, style)),
        text_(LettersOf(view, style)),
        lost_s_(std::max(style.lost_packet_s, view.step_s)) {}

  MarkerArray Build() {
    Links();
    Packets();
    Carriers();
    Clashes("collision", LinkState::COLLISION, Color(1.0, 0.45, 0.0, 0.55));
    Clashes("half_duplex", LinkState::HALF_DUPLEX, Color(0.85, 0.35, 1.0, 0.55));
    return std::move(array_);
  }

 private:
  bool Seen(int i) const {
    return i >= 0 && i < static_cast<int>(view_.vehicles.size()) &&
           view_.vehicles[static_cast<size_t>(i)].seen;
  }
  const Point& PositionOf(int i) const {
    return view_.vehicles[static_cast<size_t>(i)].pose.position;
  }

  /// One line per directed link: the half at the receiver, in the link's colour.
  void Links() {
    Marker m = Lines("link", 0, Marker::LINE_LIST, 0.05 * unit_, Color(1, 1, 1));
    for (const auto& [pair, link] : view_.links) {
      if (!Seen(pair.first) || !Seen(pair.second)) continue;
      const Point& to = PositionOf(pair.second);
      m.points.push_back(Between(PositionOf(pair.first), to, 0.5));
      m.points.push_back(to);
      m.colors.insert(m.colors.end(), 2, QualityColor(link.quality));
    }
    Add(std::move(m));
  }

  /// Packets travel as dots. A lost packet ends in a red cross on the way, with a broken line to
  /// it.
  void Packets() {
    Marker dots = New("packet", 0, Marker::SPHERE_LIST, Color(1, 1, 1));
    dots.scale.x = dots.scale.y = dots.scale.z = 0.18 * unit_;
    Marker crosses = Lines("lost_packet", 0, Marker::LINE_LIST, 0.07 * unit_, Color(1, 0.1, 0.1));
    Marker dashes =
        Lines("lost_packet", 1, Marker::LINE_LIST, 0.05 * unit_, Color(1, 0.1, 0.1, 0.8));
    std::map<std::pair<int, int>, std::uint8_t> shown;
    for (const PacketEvent& e : view_.packets) {
      if (!Seen(e.source) || !Seen(e.destination)) continue;
      const double age = view_.now - e.time;
      if (age < 0.0) continue;  // still on its way
      const Point &from = PositionOf(e.source), &to = PositionOf(e.destination);
      const double travelled = std::clamp(age / style_.packet_s, 0.0, 1.0);
      if (!e.lost) {
        if (travelled < 1.0) dots.points.push_back(Between(from, to, travelled));
      } else if (age < lost_s_) {
        shown[{e.source, e.destination}] = e.reason;
      }
    }
    for (const auto& [pair, reason] : shown) {
      const Point &from = PositionOf(pair.first), &to = PositionOf(pair.second);
      const Point end = Between(from, to, 0.62);
      const double s = 0.15 * unit_;
      for (const double sign : {-1.0, 1.0}) {
        crosses.points.insert(crosses.points.end(),
                              {Sum(end, At(-s, -sign * s, -s)), Sum(end, At(s, sign * s, s)),
                               Sum(end, At(-s, sign * s, s)), Sum(end, At(s, -sign * s, -s))});
      }
      constexpr int kDashes = 8;
      for (int k = 0; k < kDashes; ++k) {
        dashes.points.push_back(Between(from, end, (k + 0.2) / kDashes));
        dashes.points.push_back(Between(from, end, (k + 0.7) / kDashes));
      }
    }
    Add(std::move(dots));
    Add(std::move(crosses));
    Add(std::move(dashes));
    LostReasons(shown);
  }

  /// Writes the reason at each cross, only in small swarms where it is readable.
  void LostReasons(const std::map<std::pair<int, int>, std::uint8_t>& shown) {
    const int count = static_cast<int>(view_.vehicles.size());
    if (count > kManyVehicles) return;
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < count; ++j) {
        const auto found = shown.find({i, j});
        if (found == shown.end()) {
          if (i != j) Delete("lost_reason", i * count + j, Marker::TEXT_VIEW_FACING);
          continue;
        }
        const Point end = Between(PositionOf(i), PositionOf(j), 0.62);
        Text("lost_reason", i * count + j, Sum(end, At(0, 0, 0.2 * unit_ + 0.5 * text_)),
             0.7 * text_, DropReasonName(found->second), Color(1, 0.45, 0.4));
      }
    }
  }

  /// A double ring around each modem that sends, and the moving front of its sound.
  void Carriers() {
    Marker fronts =
        Lines("sound_front", 0, Marker::LINE_LIST, 0.02 * unit_, Color(0.2, 0.95, 1.0, 0.45));
    std::set<int> sending;
    for (const CarrierView& c : view_.carriers) {
      if (!Seen(c.source)) continue;
      // If time advances in long steps, all modems that have sent since the previous step get a
      // ring.
      const double after_s = std::max(style_.carrier_s - (c.end - c.begin), view_.step_s);
      if (view_.now >= c.begin && view_.now <= c.end + after_s) sending.insert(c.source);
      const double radius = kSoundSpeed_mps * (view_.now - c.begin);
      if (radius > 0.0 && radius < 2.0 * view_.scene.half_extent_m) {
        const Point& p = PositionOf(c.source);
        for (int k = 0; k <= 96; ++k) {
          for (const int end : {k, k + 1}) {
            const double angle = 2.0 * kPi * end / 96.0;
            fronts.points.push_back(
                Sum(p, At(radius * std::cos(angle), radius * std::sin(angle), 0.0)));
          }
        }
      }
    }
    Add(std::move(fronts));
    for (int i = 0; i < static_cast<int>(view_.vehicles.size()); ++i) {
      for (int ring = 0; ring < 2; ++ring) {
        const int id = 2 * i + ring;
        if (sending.count(i) == 0) {
          Delete("carrier", id, Marker::LINE_STRIP);
        } else {
          Circle("carrier", id, PositionOf(i), (1.3 + 0.3 * ring) * unit_, 0.06 * unit_,
                 Color(0.2, 0.95, 1.0, 0.9 - 0.4 * ring));
        }
      }
    }
  }

  /// A ball around each receiver that recently lost a packet for this reason.
  void Clashes(const char* name, std::uint8_t reason, const std_msgs::ColorRGBA& color) {
    std::map<int, double> since;
    for (const PacketEvent& e : view_.packets) {
      const double age = view_.now - e.time;
      if (e.lost && e.reason == reason && Seen(e.destination) && age >= 0.0 && age < lost_s_) {
        since[e.destination] = age;
      }
    }
    for (int i = 0; i < static_cast<int>(view_.vehicles.size()); ++i) {
      const auto found = since.find(i);
      if (found == since.end()) {
        Delete(name, i, Marker::SPHERE);
        continue;
      }
      std_msgs::ColorRGBA fading = color;
      fading.a *= static_cast<float>(1.0 - 0.7 * found->second / lost_s_);
      Sphere(name, i, PositionOf(i), 2.4 * unit_, fading);
    }
  }

  const SwarmView& view_;
  const MarkerStyle& style_;
  const double unit_, text_;
  const double lost_s_;  ///< simulated time for which a lost packet stays visible
};

}  // namespace

const char* DropReasonName(std::uint8_t reason) {
  static const char* const kNames[] = {"none",         "range",  "loss",  "collision",
                                       "half duplex",  "fading", "burst", "queue",
                                       "not acquired", "shadow", "left"};
  return reason < sizeof(kNames) / sizeof(kNames[0]) ? kNames[reason] : "unknown";
}

void AddNetworkMarkers(const SwarmView& view, const MarkerStyle& style, MarkerArray* array) {
  const MarkerArray network = NetworkBuilder(view, style).Build();
  array->markers.insert(array->markers.end(), network.markers.begin(), network.markers.end());
}

}  // namespace stg::nodes

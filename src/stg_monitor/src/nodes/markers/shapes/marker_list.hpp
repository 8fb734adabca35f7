#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <utility>

#include "marker_palette.hpp"

namespace stg::nodes {

/// A growing array of markers in frame world, and functions that add shapes.
class MarkerList {
 public:
  using Marker = visualization_msgs::Marker;
  using Point = geometry_msgs::Point;
  using ColorRGBA = std_msgs::ColorRGBA;

  Marker New(const char* name, int id, int type, const ColorRGBA& color) const {
    Marker m;
    m.header.frame_id = "world";  // stamp zero: always drawn, independent of the clock
    m.ns = name;
    m.id = id;
    m.type = type;
    m.action = Marker::ADD;
    m.pose.orientation.w = 1.0;
    m.color = color;
    return m;
  }
  Marker Lines(const char* name, int id, int type, double width, const ColorRGBA& color) const {
    Marker m = New(name, id, type, color);
    m.scale.x = width;
    return m;
  }
  /// rviz warns about lists without points and texts without letters, so they are deleted.
  void Add(Marker m) {
    const bool list = m.type == Marker::LINE_LIST || m.type == Marker::LINE_STRIP ||
                      m.type == Marker::SPHERE_LIST;
    const size_t needed = m.type == Marker::SPHERE_LIST ? 1 : 2;
    if (list && m.points.size() < needed) m.action = Marker::DELETE;
    array_.markers.push_back(std::move(m));
  }
  void Delete(const char* name, int id, int type) {
    Marker m = New(name, id, type, Color(0, 0, 0));
    m.action = Marker::DELETE;
    array_.markers.push_back(std::move(m));
  }
  void Sphere(const char* name, int id, const Point& p, double diameter, const ColorRGBA& color) {
    Marker m = New(name, id, Marker::SPHERE, color);
    m.pose.position = p;
    m.scale.x = m.scale.y = m.scale.z = diameter;
    Add(std::move(m));
  }
  void Text(const char* name, int id, const Point& p, double height, const std::string& text,
            const ColorRGBA& color) {
    Marker m = New(name, id, Marker::TEXT_VIEW_FACING, color);
    m.pose.position = p;
    m.scale.z = height;
    m.text = text;
    Add(std::move(m));
  }
  void Mesh(const char* name, int id, const geometry_msgs::Pose& pose, double length,
            const char* file, const ColorRGBA& color) {
    Marker m = New(name, id, Marker::MESH_RESOURCE, color);
    m.pose = pose;
    m.scale.x = m.scale.y = m.scale.z = length;
    m.mesh_resource = std::string("package://stg_bringup/meshes/") + file;
    Add(std::move(m));
  }

  void Circle(const char* name, int id, const Point& centre, double radius, double width,
              const ColorRGBA& color) {
    Marker m = Lines(name, id, Marker::LINE_STRIP, width, color);
    for (int k = 0; k <= 64; ++k) {
      const double angle = 2.0 * kPi * k / 64.0;
      m.points.push_back(Sum(centre, At(radius * std::cos(angle), radius * std::sin(angle), 0.0)));
    }
    Add(std::move(m));
  }

 protected:
  visualization_msgs::MarkerArray array_;
};

}  // namespace stg::nodes

#include "belief_markers.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "shapes/marker_list.hpp"

namespace stg::nodes {
namespace {

class BeliefBuilder : private MarkerList {
 public:
  BeliefBuilder(const SwarmView& view, const MarkerStyle& style)
      : view_(view), unit_(UnitOf(view, style)) {}

  visualization_msgs::MarkerArray Build() {
    for (std::size_t i = 0; i < view_.vehicles.size(); ++i) {
      const VehicleView& v = view_.vehicles[i];
      if (!v.seen) continue;
      Estimate(static_cast<int>(i), v);
      Detection(static_cast<int>(i), v);
    }
    return std::move(array_);
  }

 private:
  void Estimate(int id, const VehicleView& v) {
    if (!v.target_known) {
      Delete("estimate", id, Marker::SPHERE);
      Delete("estimate_std", id, Marker::SPHERE);
      Delete("follows", id, Marker::LINE_LIST);
      Delete("ring", id, Marker::LINE_STRIP);
      return;
    }
    if (view_.targets.size() > 1) {
      // A broken line, because trails and links are whole ones.
      Marker line = Lines("follows", id, Marker::LINE_LIST, 0.12 * unit_, PhaseColor(v.phase, 0.9));
      for (int k = 0; k < 2 * kDashes; k += 2) {
        for (const int end : {k, k + 1}) {
          line.points.push_back(
              Between(v.pose.position, v.estimate, static_cast<double>(end) / (2 * kDashes - 1)));
        }
      }
      Add(std::move(line));
    }
    Sphere("estimate", id, v.estimate, 0.3 * unit_, PhaseColor(v.phase, 0.9));
    Marker m = New("estimate_std", id, Marker::SPHERE, PhaseColor(v.phase, 0.12));
    m.pose.position = v.estimate;
    m.scale.x = m.scale.y = m.scale.z = std::max(2.0 * v.estimate_std, 0.3 * unit_);
    ShapeAs(v.covariance, &m);
    Add(std::move(m));
    // Laws go to the circle only in open water, and only while they know where its middle is.
    if (view_.scene.sea.open && v.estimate_std <= view_.scene.lost_std_m) {
      Circle("ring", id, v.estimate, view_.scene.desired_distance_m, 0.04 * unit_,
             PhaseColor(v.phase, 0.8));
    } else {
      Delete("ring", id, Marker::LINE_STRIP);
    }
  }

  /// Turns a sphere into the ellipsoid of one standard deviation; its axes have a visible minimum
  /// length. An invalid covariance (an old recording has none) changes nothing.
  void ShapeAs(const std::array<double, 6>& xx_xy_xz_yy_yz_zz, Marker* m) const {
    const auto& c = xx_xy_xz_yy_yz_zz;
    Eigen::Matrix3d P;
    P << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
    if (!P.allFinite() || P.trace() <= 0.0) return;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(P);
    if (axes.info() != Eigen::Success || axes.eigenvalues().minCoeff() < 0.0) return;
    Eigen::Matrix3d R = axes.eigenvectors();
    if (R.determinant() < 0.0) R.col(0) *= -1.0;
    const Eigen::Quaterniond q(R);
    m->pose.orientation.w = q.w();
    m->pose.orientation.x = q.x();
    m->pose.orientation.y = q.y();
    m->pose.orientation.z = q.z();
    const Eigen::Vector3d size = (2.0 * axes.eigenvalues().cwiseSqrt()).cwiseMax(0.3 * unit_);
    m->scale.x = size.x();
    m->scale.y = size.y();
    m->scale.z = size.z();
  }

  void Detection(int id, const VehicleView& v) {
    const DetectionView& d = v.detection;
    const double age = view_.now - d.time;
    const bool fresh = age >= 0.0 && age <= std::max(kShown_s, 2.0 * view_.step_s);
    const auto colour = Color(1.0, 0.9, 0.3, 0.55);
    const Point& p = v.pose.position;
    if (fresh && d.has_bearing) {
      Marker ray = Lines("detection_ray", id, Marker::LINE_LIST, 0.03 * unit_, colour);
      const double length = d.has_range ? d.range_m : view_.scene.sensing_range_m;
      const double level = std::cos(d.elevation_rad) * length;
      ray.points = {p, Sum(p, At(level * std::cos(d.azimuth_rad), level * std::sin(d.azimuth_rad),
                                 length * std::sin(d.elevation_rad)))};
      Add(std::move(ray));
    } else {
      Delete("detection_ray", id, Marker::LINE_LIST);
    }
    if (fresh && d.has_range && !d.has_bearing) {
      Circle("detection_range", id, p, d.range_m, 0.03 * unit_, colour);
    } else {
      Delete("detection_range", id, Marker::LINE_STRIP);
    }
  }

  /// A detection is shown for at least this simulated time.
  static constexpr double kShown_s = 0.3;
  static constexpr int kDashes = 16;

  const SwarmView& view_;
  const double unit_;
};

}  // namespace

void AddBeliefMarkers(const SwarmView& view, const MarkerStyle& style,
                      visualization_msgs::MarkerArray* array) {
  const visualization_msgs::MarkerArray beliefs = BeliefBuilder(view, style).Build();
  array->markers.insert(array->markers.end(), beliefs.markers.begin(), beliefs.markers.end());
}

}  // namespace stg::nodes

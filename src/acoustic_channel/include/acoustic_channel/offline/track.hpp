#pragma once

#include <string>
#include <vector>

#include "auv_common/numbers/vector.hpp"

namespace stg::acoustics {

/// The position of a vehicle over time: straight lines between points, at rest before the first and
/// after the last.
class Track {
 public:
  struct Point {
    double t_s;
    Vec3<double> p_W;
  };

  /// @param points at least one, of ascending times
  explicit Track(std::vector<Point> points) : points_(std::move(points)) {}
  /// A straight line without end from p_W at time 0.
  static Track Line(const Vec3<double>& p_W, const Vec3<double>& v_W);
  /// A CSV file whose first line is `t,x,y,z`: seconds and metres, ENU. Throws UserError with file
  /// and line.
  static Track Load(const std::string& file);

  void At(double t_s, Vec3<double>* p_W, Vec3<double>* v_W) const;
  /// Both times, and the times between them at which the direction may change.
  std::vector<double> Corners(double from_s, double to_s) const;

 private:
  std::vector<Point> points_;
  Vec3<double> v_W_;  ///< of a line
};

}  // namespace stg::acoustics

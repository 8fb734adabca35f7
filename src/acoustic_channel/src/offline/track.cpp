#include "acoustic_channel/offline/track.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "auv_common/config/yaml_tree.hpp"
#include "auv_common/error.hpp"
#include "auv_common/regular_file.hpp"

namespace stg::acoustics {
namespace {

/// Limits of a node of a network: distance, speed and duration.
constexpr double kFarthest_m = 1e7, kFastest_mps = 100.0, kLongest_s = 1e8;

double Largest(const Vec3<double>& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.remove_suffix(1);
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  return text;
}

/// Parses a row of four finite numbers. Returns false for anything else.
bool ParseRow(std::string_view row, double values[4]) {
  for (int i = 0; i < 4; ++i) {
    const auto comma = row.find(',');
    if ((comma == std::string_view::npos) != (i == 3)) return false;
    const std::string_view cell = Trimmed(row.substr(0, comma));
    const auto end = std::from_chars(cell.data(), cell.data() + cell.size(), values[i]);
    if (end.ec != std::errc() || end.ptr != cell.data() + cell.size()) return false;
    if (!std::isfinite(values[i])) return false;
    if (i < 3) row.remove_prefix(comma + 1);
  }
  return true;
}

}  // namespace

Track Track::Line(const Vec3<double>& p_W, const Vec3<double>& v_W) {
  Track track({{0.0, p_W}});
  track.v_W_ = v_W;
  return track;
}

Track Track::Load(const std::string& file) {
  std::ifstream in = OpenText(file);
  std::vector<Point> points;
  std::string row;
  for (int line = 1; std::getline(in, row); ++line) {
    const std::string where = file + ":" + std::to_string(line) + ": ";
    const std::string_view text = Trimmed(row);
    if (line == 1) {
      if (text != "t,x,y,z") {
        throw UserError(where + "expected the header t,x,y,z, found " + config::Quoted(row));
      }
      continue;
    }
    if (text.empty()) continue;
    double v[4];
    if (!ParseRow(text, v)) {
      throw UserError(where + "expected four finite numbers, found " + config::Quoted(row));
    }
    if (!points.empty() && v[0] <= points.back().t_s) {
      throw UserError(where + "t: each time must be later than the one before");
    }
    if (std::abs(v[0]) > kLongest_s) throw UserError(where + "t: beyond +-1e8 s");
    const Vec3<double> p{v[1], v[2], v[3]};
    if (Largest(p) > kFarthest_m) throw UserError(where + "x, y, z: beyond +-1e7 m");
    if (!points.empty()) {
      const Point& from = points.back();
      const double limit_m = kFastest_mps * (v[0] - from.t_s);
      if (!(Largest(p - from.p_W) <= limit_m)) {
        throw UserError(where + "faster than 100 m/s since the point before");
      }
    }
    points.push_back({v[0], p});
  }
  if (points.empty()) throw UserError(file + ": no points");
  return Track(std::move(points));
}

void Track::At(double t_s, Vec3<double>* p_W, Vec3<double>* v_W) const {
  if (points_.size() == 1) {
    *p_W = points_[0].p_W + v_W_ * t_s;
    *v_W = v_W_;
    return;
  }
  const auto after = std::upper_bound(points_.begin(), points_.end(), t_s,
                                      [](double t, const Point& point) { return t < point.t_s; });
  *v_W = {};
  if (after == points_.begin()) {
    *p_W = points_.front().p_W;
  } else if (after == points_.end()) {
    *p_W = points_.back().p_W;
  } else {
    const Point& from = *(after - 1);
    *v_W = (after->p_W - from.p_W) * (1.0 / (after->t_s - from.t_s));
    *p_W = from.p_W + *v_W * (t_s - from.t_s);
  }
}

std::vector<double> Track::Corners(double from_s, double to_s) const {
  std::vector<double> times{from_s};
  for (const Point& point : points_) {
    if (point.t_s > from_s && point.t_s < to_s) times.push_back(point.t_s);
  }
  times.push_back(to_s);
  return times;
}

}  // namespace stg::acoustics

#include "auv_dynamics/terrain/terrain.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "auv_common/error.hpp"

namespace stg::dynamics {
namespace {

constexpr double kMetresPerDegree = 111'000.0;  // in latitude; only for the size of a cell
constexpr std::size_t kMostSide = 4001;

/// Smallest squared distance in the plane between a segment and the origin.
double NearestSquared(double ax, double ay, double bx, double by) {
  const double dx = bx - ax, dy = by - ay, length = dx * dx + dy * dy;
  const double t = length > 0.0 ? std::clamp(-(ax * dx + ay * dy) / length, 0.0, 1.0) : 0.0;
  const double x = ax + t * dx, y = ay + t * dy;
  return x * x + y * y;
}

}  // namespace

double Obstacle::Distance(const Vec3<double>& p) const {
  const Vec3<double> d = p - p_W;
  if (kind == Kind::kSphere) return Norm(d) - radius_m;
  const double side = std::hypot(d.x, d.y) - radius_m;
  const double end = std::abs(d.z - 0.5 * height_m) - 0.5 * height_m;
  if (side <= 0.0 || end <= 0.0) return std::max(side, end);
  return std::hypot(side, end);
}

Pack Obstacle::Inside(const Vec3<Pack>& p) const {
  const Pack dx = p.x - Pack(p_W.x), dy = p.y - Pack(p_W.y), dz = p.z - Pack(p_W.z);
  const Pack zero(0.0), one(1.0), square(radius_m * radius_m), level = dx * dx + dy * dy;
  if (kind == Kind::kSphere) return Select(level + dz * dz < square, one, zero);
  return Select((level < square) && (dz > zero) && (dz < Pack(height_m)), one, zero);
}

Vec3<double> Obstacle::Expel(Vec3<double>* p) const {
  const Vec3<double> d = *p - p_W;
  // The centre or axis has no unique nearest point, so any direction works.
  const auto outward = [](const Vec3<double>& r) {
    const double length = Norm(r);
    return length > 1e-9 ? r * (1.0 / length) : Vec3<double>{1.0, 0.0, 0.0};
  };
  if (kind == Kind::kSphere) {
    const Vec3<double> out = outward(d);
    *p = p_W + out * radius_m;
    return out;
  }
  const Vec3<double> level{d.x, d.y, 0.0};
  const double side = radius_m - Norm(level), top = height_m - d.z;
  if (top < side && top < d.z) {
    p->z = p_W.z + height_m;
    return {0.0, 0.0, 1.0};
  }
  if (d.z < side) {
    p->z = p_W.z;
    return {0.0, 0.0, -1.0};
  }
  const Vec3<double> out = outward(level);
  *p = Vec3<double>{p_W.x, p_W.y, p->z} + out * radius_m;
  return out;
}

bool Obstacle::Blocks(const Vec3<double>& a, const Vec3<double>& b) const {
  const Vec3<double> from = a - p_W, along = b - a;
  if (kind == Kind::kSphere) {
    const double length = Dot(along, along);
    const double t = length > 0.0 ? std::clamp(-Dot(from, along) / length, 0.0, 1.0) : 0.0;
    const Vec3<double> nearest = from + along * t;
    return Dot(nearest, nearest) <= radius_m * radius_m;
  }
  // First the part of the segment between foot and top, then the distance in the plane.
  double begin = 0.0, end = 1.0;
  if (along.z == 0.0) {
    if (from.z < 0.0 || from.z > height_m) return false;
  } else {
    const double foot = -from.z / along.z, top = (height_m - from.z) / along.z;
    begin = std::max(begin, std::min(foot, top));
    end = std::min(end, std::max(foot, top));
    if (begin > end) return false;
  }
  const Vec3<double> p = from + along * begin, q = from + along * end;
  return NearestSquared(p.x, p.y, q.x, q.y) <= radius_m * radius_m;
}

Terrain::Terrain(double depth_m) : depth_(depth_m), highest_(-depth_m) {
  if (!(depth_m > 0.0)) throw UserError("terrain: the bottom must lie below the surface");
}

Terrain::Terrain(const Bathymetry& grid, const Datum& datum, double half_size_m)
    : half_size_(half_size_m) {
  if (!(half_size_m > 0.0))
    throw UserError("terrain: the half size of the region must be positive");
  const double cell_deg = grid.latitudes()[1] - grid.latitudes()[0];
  const double wanted = std::max(1.0, 0.5 * cell_deg * kMetresPerDegree);
  const double cells = std::ceil(2.0 * half_size_m / wanted);
  if (!(cells + 1.0 <= static_cast<double>(kMostSide))) {
    throw UserError("terrain: the region is too large for the grid's resolution");
  }
  side_ = static_cast<std::size_t>(cells) + 1;
  spacing_ = 2.0 * half_size_m / cells;
  heights_.reserve(side_ * side_);
  for (std::size_t row = 0; row < side_; ++row) {
    for (std::size_t column = 0; column < side_; ++column) {
      const double x = -half_size_ + spacing_ * static_cast<double>(column);
      const double y = -half_size_ + spacing_ * static_cast<double>(row);
      const Datum::Geodetic at = datum.ToGeodetic({x, y, 0.0});
      if (!grid.Covers(at.latitude_deg, at.longitude_deg)) {
        const Datum::Geodetic origin = datum.ToGeodetic({});
        const GeoRegion r = grid.region();
        throw UserError("terrain: a region of " + std::to_string(half_size_m) +
                        " m around latitude " + std::to_string(origin.latitude_deg) +
                        ", longitude " + std::to_string(origin.longitude_deg) +
                        " is not within the grid, which covers " + std::to_string(r.south) +
                        " to " + std::to_string(r.north) + " N, " + std::to_string(r.west) +
                        " to " + std::to_string(r.east) + " E");
      }
      heights_.push_back(static_cast<float>(grid.At(at.latitude_deg, at.longitude_deg)));
    }
  }
  highest_ = *std::max_element(heights_.begin(), heights_.end());
}

double Terrain::Height(double x, double y) const {
  if (flat()) return -depth_;
  const double last = static_cast<double>(side_ - 1);
  const auto place = [&](double at, std::size_t* index) {
    const double cells = std::clamp((at + half_size_) / spacing_, 0.0, last);
    *index = std::min(static_cast<std::size_t>(cells), side_ - 2);
    return cells - static_cast<double>(*index);
  };
  std::size_t column = 0, row = 0;
  const double u = place(x, &column), v = place(y, &row);
  const float* h = heights_.data() + row * side_ + column;
  const double south = h[0] + u * (double{h[1]} - h[0]);
  const double north = h[side_] + u * (double{h[side_ + 1]} - h[side_]);
  return south + v * (north - south);
}

bool LineOfSight(const Terrain& terrain, const std::vector<Obstacle>& obstacles,
                 const Vec3<double>& a, const Vec3<double>& b) {
  for (const Obstacle& obstacle : obstacles) {
    if (obstacle.Blocks(a, b)) return false;
  }
  if (std::min(a.z, b.z) > terrain.highest()) return true;
  if (terrain.Altitude(a) < 0.0 || terrain.Altitude(b) < 0.0) return false;
  if (terrain.flat()) return true;
  // Symmetric in a and b: the points are evenly spaced between them.
  const double pieces = std::ceil(std::hypot(b.x - a.x, b.y - a.y) / (0.5 * terrain.spacing_m()));
  const auto steps = static_cast<std::int64_t>(pieces);
  for (std::int64_t k = 1; k < steps; ++k) {
    const auto from_a = static_cast<double>(k), from_b = static_cast<double>(steps - k);
    const Vec3<double> p = (a * from_b + b * from_a) * (1.0 / pieces);
    if (terrain.Altitude(p) < 0.0) return false;
  }
  return true;
}

}  // namespace stg::dynamics

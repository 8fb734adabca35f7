#include "auv_dynamics/terrain/bathymetry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "auv_common/error.hpp"

namespace stg::dynamics {
namespace {

/// Number of the cell that contains a value on an ascending, even axis, and the value's position in
/// it as a share of the cell.
std::size_t CellOf(const std::vector<double>& axis, double value, double* share) {
  const double step = (axis.back() - axis.front()) / static_cast<double>(axis.size() - 1);
  const double cells = (value - axis.front()) / step;
  const auto cell = static_cast<std::size_t>(
      std::clamp(std::floor(cells), 0.0, static_cast<double>(axis.size() - 2)));
  *share = std::clamp(cells - static_cast<double>(cell), 0.0, 1.0);
  return cell;
}

/// Adds full circles to a longitude so that it lies on the axis; unchanged if this is impossible.
double OntoAxis(const std::vector<double>& axis, double longitude) {
  for (const double turn : {0.0, 360.0, -360.0}) {
    if (longitude + turn >= axis.front() && longitude + turn <= axis.back()) {
      return longitude + turn;
    }
  }
  return longitude;
}

}  // namespace

Bathymetry::Bathymetry(std::vector<double> latitudes, std::vector<double> longitudes,
                       std::vector<float> elevation_m)
    : latitudes_(std::move(latitudes)),
      longitudes_(std::move(longitudes)),
      elevation_(std::move(elevation_m)) {
  if (latitudes_.size() < 2 || longitudes_.size() < 2 ||
      elevation_.size() != latitudes_.size() * longitudes_.size()) {
    throw UserError(
        "bathymetry: a grid needs at least two points along each axis and one elevation for each "
        "point");
  }
}

bool Bathymetry::Covers(double latitude, double longitude) const {
  const double on = OntoAxis(longitudes_, longitude);
  return latitude >= latitudes_.front() && latitude <= latitudes_.back() &&
         on >= longitudes_.front() && on <= longitudes_.back();
}

double Bathymetry::At(double latitude, double longitude) const {
  if (!Covers(latitude, longitude)) {
    char text[128];
    std::snprintf(text, sizeof(text), "bathymetry: %.6f N %.6f E lies outside the grid", latitude,
                  longitude);
    throw UserError(text);
  }
  double u = 0.0, v = 0.0;
  const std::size_t row = CellOf(latitudes_, latitude, &v);
  const std::size_t column = CellOf(longitudes_, OntoAxis(longitudes_, longitude), &u);
  const double corners[] = {point(row, column), point(row, column + 1), point(row + 1, column),
                            point(row + 1, column + 1)};
  const double south = (1.0 - u) * corners[0] + u * corners[1];
  const double north = (1.0 - u) * corners[2] + u * corners[3];
  // A sum of rounded shares may leave the range of the corners by a last digit, even on level
  // ground.
  const auto [lowest, highest] = std::minmax_element(std::begin(corners), std::end(corners));
  return std::clamp((1.0 - v) * south + v * north, *lowest, *highest);
}

GeoRegion Bathymetry::region() const {
  return {latitudes_.front(), latitudes_.back(), longitudes_.front(), longitudes_.back()};
}

double Bathymetry::lowest() const {
  return *std::min_element(elevation_.begin(), elevation_.end());
}

double Bathymetry::highest() const {
  return *std::max_element(elevation_.begin(), elevation_.end());
}

}  // namespace stg::dynamics

#pragma once

#include <string>
#include <vector>

/// Depths and heights of a part of the Earth, from files of the usual grids.
namespace stg::dynamics {

/// A part of the Earth, degrees. East of the date line longitudes continue above 180.
struct GeoRegion {
  double south = 0.0, north = 0.0;  ///< latitude
  double west = 0.0, east = 0.0;    ///< longitude
};

/// A grid of elevations over latitude and longitude (WGS 84), negative below the sea. Between grid
/// points it is bilinear in latitude and longitude.
class Bathymetry {
 public:
  /// Largest number of points.
  static constexpr std::size_t kMostPoints = 25'000'000;

  /// Reads a NetCDF file (classic or 4): the variable `elevation`, `z`, `topo`, `ROSE` or the only
  /// one over latitude and longitude, in either order, of any numeric type, packed (scale_factor,
  /// add_offset) or not, metres, positive up unless its attribute `positive` says down. GEBCO and
  /// ETOPO have such files.
  ///
  /// Throws UserError with the file and the error: not NetCDF, or damaged; no such variable, or
  /// several; axes that are too short, not evenly spaced, or not latitude and longitude; a region
  /// that it does not cover; missing or impossible elevations; more points than kMostPoints.
  /// Missing values are not filled in.
  static Bathymetry Load(const std::string& file);
  /// Reads only the part that covers the region: its points and the points around them.
  static Bathymetry Load(const std::string& file, const GeoRegion& region);

  /// @param elevation_m [latitudes, longitudes], row-major, both axes ascending
  Bathymetry(std::vector<double> latitudes, std::vector<double> longitudes,
             std::vector<float> elevation_m);

  /// Writes it as GEBCO does: `elevation(lat, lon)` int16 [m], rounded; NetCDF classic. Throws
  /// UserError when the file cannot be written.
  /// @param note text for the attribute `history`
  void Save(const std::string& file, const std::string& note) const;

  /// Elevation [m]; throws UserError for a point outside the grid.
  double At(double latitude, double longitude) const;
  bool Covers(double latitude, double longitude) const;

  const std::vector<double>& latitudes() const { return latitudes_; }
  const std::vector<double>& longitudes() const { return longitudes_; }
  float point(std::size_t row, std::size_t column) const {
    return elevation_[row * longitudes_.size() + column];
  }
  GeoRegion region() const;
  double lowest() const;
  double highest() const;

 private:
  std::vector<double> latitudes_, longitudes_;
  std::vector<float> elevation_;
};

}  // namespace stg::dynamics

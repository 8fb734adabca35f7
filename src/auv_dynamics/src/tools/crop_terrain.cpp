#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "auv_common/command_line.hpp"
#include "auv_common/error.hpp"
#include "auv_common/program.hpp"
#include "auv_dynamics/terrain/bathymetry.hpp"

namespace {

using stg::dynamics::Bathymetry;

/// Prints a map in letters with north up: `#` is land; digits are tenths of the largest depth.
void Show(const Bathymetry& grid, int columns) {
  const stg::dynamics::GeoRegion r = grid.region();
  const double width = r.east - r.west, height = r.north - r.south;
  // A letter is about twice as high as it is wide.
  const int rows = static_cast<int>(std::clamp(columns * height / width / 2.0, 2.0, 400.0));
  const double deepest = std::max(1.0, -grid.lowest());
  std::printf("%.4f to %.4f N, %.4f to %.4f E; %zu x %zu points, %.0f to %.0f m\n", r.south,
              r.north, r.west, r.east, grid.latitudes().size(), grid.longitudes().size(),
              grid.lowest(), grid.highest());
  for (int i = 0; i < rows; ++i) {
    std::string line;
    for (int k = 0; k < columns; ++k) {
      const double elevation =
          grid.At(r.north - height * (i + 0.5) / rows, r.west + width * (k + 0.5) / columns);
      const int tenth = std::clamp(static_cast<int>(-elevation / deepest * 10.0), 0, 9);
      line += elevation >= 0.0 ? '#' : static_cast<char>('0' + tenth);
    }
    std::printf("  %s\n", line.c_str());
  }
  std::printf("  #: land; 0 to 9: depth in steps of %.0f m\n", deepest / 10.0);
}

}  // namespace

/// Crops a region of a bathymetry file and shows it. The last line is JSON. Exit status 2: unusable
/// input.
int main(int argc, char** argv) {
  stg::CommandLine app(
      "crop_terrain",
      "Shows a NetCDF bathymetry (such as GEBCO or ETOPO) and crops a region of it. A crop is "
      "written in GEBCO's format: elevation(lat, lon) in whole metres.");
  std::string file, out;
  std::vector<double> region;
  int columns = 72;
  app.Add("file", &file, "NetCDF file").Required();
  app.Add("--region", &region, "SOUTH NORTH WEST EAST in degrees; default: the whole file")
      .Values(4);
  app.Add("--out", &out, "write the region to this file");
  app.Add("--columns", &columns, "width of the map in letters").ShowDefault().From(2, 400);
  return app.Run(argc, argv, [&] {
    const Bathymetry grid =
        region.empty() ? Bathymetry::Load(file)
                       : Bathymetry::Load(file, {region[0], region[1], region[2], region[3]});
    Show(grid, columns);
    if (!out.empty()) {
      std::error_code error;  // for an output that does not exist yet
      if (std::filesystem::equivalent(out, file, error)) {
        throw stg::UserError(out + ": is the input file; write to another file");
      }
      const std::string name = file.substr(file.find_last_of('/') + 1);
      grid.Save(out, "cropped from " + name + " by crop_terrain");
    }
    const stg::dynamics::GeoRegion r = grid.region();
    stg::PrintResult(
        nlohmann::json{{"region", {r.south, r.north, r.west, r.east}},
                       {"points", {grid.latitudes().size(), grid.longitudes().size()}},
                       {"lowest_m", grid.lowest()},
                       {"highest_m", grid.highest()},
                       {"file", out.empty() ? nlohmann::json() : nlohmann::json(out)}});
    return 0;
  });
}

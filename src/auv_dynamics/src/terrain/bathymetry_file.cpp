#include <algorithm>
#include <cctype>
#include <cmath>

#include "auv_common/durable_file.hpp"
#include "auv_dynamics/terrain/bathymetry.hpp"
#include "netcdf_file.hpp"

namespace stg::dynamics {
namespace {

using Variable = NetcdfFile::Variable;

constexpr std::size_t kLongestAxis = 1'000'000;
/// A little beyond the Challenger Deep and Mount Everest, for errors of a survey [m].
constexpr double kLowest_m = -11'100.0, kHighest_m = 8'900.0;
/// Allowed unevenness of an axis, as a share of a step: GEBCO's cells have no exact binary values.
constexpr double kUneven = 0.01;
/// A tenth of a millimetre on the ground. Closer points mean a damaged file [degrees].
constexpr double kFinest_deg = 1e-9;

bool OneOf(const std::string& text, const std::vector<const char*>& words) {
  return std::any_of(words.begin(), words.end(), [&](const char* word) { return text == word; });
}

/// One axis of the grid, as in the file.
struct Axis1 {
  std::vector<double> values;
  bool latitude = false;
  bool descending = false;
};

Axis1 ReadAxis(const NetcdfFile& file, const std::vector<Variable>& variables, int dimension) {
  const NetcdfFile::Dimension d = file.DimensionOf(dimension);
  const auto found = std::find_if(variables.begin(), variables.end(), [&](const Variable& v) {
    return v.name == d.name && v.dimensions.size() == 1 && v.dimensions[0] == dimension &&
           v.numeric;
  });
  if (found == variables.end()) file.Refuse("dimension " + d.name + " has no coordinates");
  if (d.size < 2) file.Refuse("dimension " + d.name + " has fewer than two points");
  if (d.size > kLongestAxis) file.Refuse("dimension " + d.name + " is too long");
  Axis1 axis;
  axis.values = file.Doubles(*found, d.size);
  const std::string units = file.Text(*found, "units").value_or("");
  const bool north = OneOf(units, {"degrees_north", "degree_north", "degrees_N", "degree_N"});
  const bool east = OneOf(units, {"degrees_east", "degree_east", "degrees_E", "degree_E"});
  const bool named_latitude = OneOf(d.name, {"lat", "latitude", "y"});
  const bool named_longitude = OneOf(d.name, {"lon", "longitude", "x"});
  if (!north && !east && !named_latitude && !named_longitude) {
    file.Refuse("dimension " + d.name + " is neither latitude nor longitude");
  }
  axis.latitude = north || (!east && named_latitude);
  const double step = (axis.values.back() - axis.values.front()) / static_cast<double>(d.size - 1);
  axis.descending = step < 0.0;
  if (std::abs(step) < kFinest_deg) {
    file.Refuse("the points of " + d.name + " are closer than 1e-9 degrees");
  }
  for (std::size_t k = 0; k < d.size; ++k) {
    const double even = axis.values.front() + step * static_cast<double>(k);
    if (!(std::abs(axis.values[k] - even) <= kUneven * std::abs(step))) {
      file.Refuse("the points of " + d.name + " are not evenly spaced");
    }
  }
  if (axis.descending) std::reverse(axis.values.begin(), axis.values.end());
  const double most = axis.latitude ? 90.0 : 540.0;
  if (axis.values.front() < -most - 0.01 || axis.values.back() > most + 0.01) {
    file.Refuse("the values of " + d.name + " are not " +
                (axis.latitude ? "latitudes" : "longitudes") + " in degrees");
  }
  return axis;
}

/// Finds the variable with the elevations.
const Variable& FindElevation(const NetcdfFile& file, const std::vector<Variable>& variables) {
  std::vector<const Variable*> flat;
  std::string names;
  for (const Variable& v : variables) {
    names += (names.empty() ? "" : ", ") + v.name;
    if (v.dimensions.size() == 2 && v.numeric) flat.push_back(&v);
  }
  if (flat.empty()) {
    file.Refuse("there is no variable over latitude and longitude" +
                (names.empty() ? "; it has no variables" : "; its variables are " + names));
  }
  for (const char* name : {"elevation", "z", "topo", "ROSE", "Band1", "altitude"}) {
    for (const Variable* v : flat) {
      if (v->name == name) return *v;
    }
  }
  if (flat.size() > 1) file.Refuse("several variables could be elevations: " + names);
  return *flat.front();
}

/// Points of an ascending axis, from the last one at or below `lo` to the first one at or above
/// `hi`.
struct Span {
  std::size_t first = 0, count = 0;
};
Span SpanOf(const NetcdfFile& file, const std::vector<double>& axis, double lo, double hi,
            const char* what) {
  if (!(lo < hi)) file.Refuse(std::string("the region has no extent in ") + what);
  const double slack = 1e-9 * (axis.back() - axis.front());
  if (lo < axis.front() - slack || hi > axis.back() + slack) {
    file.Refuse("covers " + std::string(what) + " " + std::to_string(axis.front()) + " to " +
                std::to_string(axis.back()) + ", not " + std::to_string(lo) + " to " +
                std::to_string(hi));
  }
  const auto above = std::upper_bound(axis.begin(), axis.end(), lo);
  const auto end = std::lower_bound(axis.begin(), axis.end(), hi);
  const std::size_t first =
      above == axis.begin() ? 0 : static_cast<std::size_t>(above - axis.begin()) - 1;
  std::size_t last =
      end == axis.end() ? axis.size() - 1 : static_cast<std::size_t>(end - axis.begin());
  last = std::max(last, std::min(first + 1, axis.size() - 1));
  return {std::min(first, last - 1), last - std::min(first, last - 1) + 1};
}

std::string LowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

/// True if the values are depths below the sea.
bool PointsDown(const NetcdfFile& file, const Variable& variable) {
  const std::string positive = file.Text(variable, "positive").value_or("up");
  const std::string word = LowerCase(positive);
  if (word != "up" && word != "down") {
    file.Refuse(variable.name + " has positive = '" + positive + "', which is neither up nor down");
  }
  return word == "down";
}

/// A file without units is taken to be in metres.
void RequireMetres(const NetcdfFile& file, const Variable& variable) {
  const std::string units = file.Text(variable, "units").value_or("");
  if (OneOf(LowerCase(units), {"", "m", "meter", "meters", "metre", "metres"})) return;
  file.Refuse(variable.name + " is in '" + units + "'; convert it to metres");
}

/// Converts the values of the file to metres above the sea.
void Unpack(const NetcdfFile& file, const Variable& variable, std::vector<float>* values) {
  const double scale = file.Number(variable, "scale_factor").value_or(1.0);
  const double offset = file.Number(variable, "add_offset").value_or(0.0);
  const auto fill = file.Number(variable, "_FillValue");
  const auto missing = file.Number(variable, "missing_value");
  const bool down = PointsDown(file, variable);
  RequireMetres(file, variable);
  std::size_t gaps = 0;
  for (float& value : *values) {
    const bool gap = !std::isfinite(value) || (fill && value == static_cast<float>(*fill)) ||
                     (missing && value == static_cast<float>(*missing));
    if (gap) {
      ++gaps;
      continue;
    }
    const double metres = (down ? -1.0 : 1.0) * (value * scale + offset);
    if (!(metres >= kLowest_m && metres <= kHighest_m)) {
      file.Refuse(variable.name + " holds " + std::to_string(metres) +
                  " m, an elevation that does not exist on Earth");
    }
    value = static_cast<float>(metres);
  }
  if (gaps == values->size()) file.Refuse("all elevations there are missing");
  if (gaps > 0) {
    file.Refuse(std::to_string(gaps) + " of " + std::to_string(values->size()) +
                " elevations there are missing");
  }
}

Bathymetry Read(const std::string& path, const GeoRegion* region) {
  const NetcdfFile file(path);
  const std::vector<Variable> variables = file.Variables();
  const Variable& variable = FindElevation(file, variables);
  const Axis1 first = ReadAxis(file, variables, variable.dimensions[0]);
  const Axis1 second = ReadAxis(file, variables, variable.dimensions[1]);
  if (first.latitude == second.latitude) {
    file.Refuse(variable.name + " does not lie over latitude and longitude");
  }
  const Axis1& lat = first.latitude ? first : second;
  const Axis1& lon = first.latitude ? second : first;
  Span rows{0, lat.values.size()}, columns{0, lon.values.size()};
  double turn = 0.0;
  if (region != nullptr) {
    rows = SpanOf(file, lat.values, region->south, region->north, "latitudes");
    for (const double t : {0.0, 360.0, -360.0}) {
      if (region->west + t >= lon.values.front() && region->east + t <= lon.values.back()) {
        turn = t;
        break;
      }
    }
    columns = SpanOf(file, lon.values, region->west + turn, region->east + turn, "longitudes");
  }
  if (rows.count > Bathymetry::kMostPoints / columns.count) {
    file.Refuse("holds " + std::to_string(rows.count) + " x " + std::to_string(columns.count) +
                " points, too many: crop a region of it");
  }
  // Start of the part in the file's own order.
  const auto begin = [](const Axis1& axis, const Span& span) {
    return axis.descending ? axis.values.size() - span.first - span.count : span.first;
  };
  const Span& span1 = first.latitude ? rows : columns;
  const Span& span2 = first.latitude ? columns : rows;
  std::vector<float> raw = file.Floats(variable, {begin(first, span1), begin(second, span2)},
                                       {span1.count, span2.count});
  Unpack(file, variable, &raw);
  std::vector<float> ordered(raw.size());
  for (std::size_t r = 0; r < rows.count; ++r) {
    for (std::size_t c = 0; c < columns.count; ++c) {
      const std::size_t in_row = lat.descending ? rows.count - 1 - r : r;
      const std::size_t in_column = lon.descending ? columns.count - 1 - c : c;
      ordered[r * columns.count + c] = first.latitude ? raw[in_row * columns.count + in_column]
                                                      : raw[in_column * rows.count + in_row];
    }
  }
  const auto cut = [](const std::vector<double>& axis, const Span& span, double shift) {
    std::vector<double> part(axis.begin() + static_cast<std::ptrdiff_t>(span.first),
                             axis.begin() + static_cast<std::ptrdiff_t>(span.first + span.count));
    for (double& value : part) value -= shift;
    return part;
  };
  return {cut(lat.values, rows, 0.0), cut(lon.values, columns, turn), std::move(ordered)};
}

}  // namespace

Bathymetry Bathymetry::Load(const std::string& file) { return Read(file, nullptr); }

Bathymetry Bathymetry::Load(const std::string& file, const GeoRegion& region) {
  return Read(file, &region);
}

void Bathymetry::Save(const std::string& path, const std::string& note) const {
  const NetcdfLibrary& netcdf = NetcdfLibrary::Get();
  const auto lock = NetcdfLibrary::Lock();
  DurableFile durable(path, "the terrain");
  int file = -1, dimensions[2] = {}, lat = -1, lon = -1, elevation = -1;
  const auto check = [&](int status) {
    if (status == NC_NOERR) return;
    if (file >= 0) netcdf.close(file);
    durable.Fail(netcdf.strerror(status));
  };
  const auto text = [&](int variable, const char* name, const std::string& value) {
    check(netcdf.put_att_text(file, variable, name, value.size(), value.data()));
  };
  check(netcdf.create(durable.temporary().c_str(), NC_CLOBBER, &file));
  check(netcdf.def_dim(file, "lat", latitudes_.size(), &dimensions[0]));
  check(netcdf.def_dim(file, "lon", longitudes_.size(), &dimensions[1]));
  check(netcdf.def_var(file, "lat", NC_DOUBLE, 1, &dimensions[0], &lat));
  check(netcdf.def_var(file, "lon", NC_DOUBLE, 1, &dimensions[1], &lon));
  check(netcdf.def_var(file, "elevation", NC_SHORT, 2, dimensions, &elevation));
  text(lat, "units", "degrees_north");
  text(lon, "units", "degrees_east");
  text(elevation, "units", "m");
  text(elevation, "positive", "up");
  text(NC_GLOBAL, "Conventions", "CF-1.6");
  text(NC_GLOBAL, "history", note);
  check(netcdf.enddef(file));
  std::vector<short> rounded;
  rounded.reserve(elevation_.size());
  for (const float value : elevation_) rounded.push_back(static_cast<short>(std::lround(value)));
  check(netcdf.put_var_double(file, lat, latitudes_.data()));
  check(netcdf.put_var_double(file, lon, longitudes_.data()));
  check(netcdf.put_var_short(file, elevation, rounded.data()));
  const int closing = file;
  file = -1;
  check(netcdf.close(closing));
  durable.Commit();
}

}  // namespace stg::dynamics

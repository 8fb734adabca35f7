#include "auv_dynamics/terrain/bathymetry.hpp"

#include <gtest/gtest.h>
#include <netcdf.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"

namespace stg::dynamics {
namespace {

namespace fs = std::filesystem;

/// Layout of a file with a grid of the plane h = 10 lat - 20 lon - 3000.
struct Layout {
  int format = NC_CLASSIC_MODEL;
  nc_type type = NC_SHORT;
  const char *lat = "lat", *lon = "lon", *name = "elevation";
  const char *lat_units = "degrees_north", *lon_units = "degrees_east";
  std::string positive, units;  // of the elevations; empty: not stated
  bool descending = false, transposed = false, coordinates = true, uneven = false;
  double scale = 1.0, offset = 0.0, fill = 0.0, sign = 1.0;
  bool packed = false, has_fill = false;
  std::function<double(int, int)> value = [](int row, int column) {
    return 10.0 * (20 + row) - 20.0 * (120 + column) - 3000.0 + 5000.0;
  };
  int rows = 5, columns = 7;
  double lon_step = 1.0;
};

class GridFile : public ::testing::Test {
 protected:
  void SetUp() override { file_ = folder_ + "/grid.nc"; }

  static void Ok(int status) { ASSERT_EQ(status, NC_NOERR) << nc_strerror(status); }

  void Write(const Layout& l) const {
    int nc = 0, dims[2] = {}, lat = 0, lon = 0, var = 0;
    Ok(nc_create(file_.c_str(), NC_CLOBBER | l.format, &nc));
    const auto rows = static_cast<size_t>(l.rows), columns = static_cast<size_t>(l.columns);
    Ok(nc_def_dim(nc, l.lat, rows, &dims[0]));
    Ok(nc_def_dim(nc, l.lon, columns, &dims[1]));
    if (l.coordinates) {
      Ok(nc_def_var(nc, l.lat, NC_DOUBLE, 1, &dims[0], &lat));
      Ok(nc_def_var(nc, l.lon, NC_DOUBLE, 1, &dims[1], &lon));
      Ok(nc_put_att_text(nc, lat, "units", std::strlen(l.lat_units), l.lat_units));
      Ok(nc_put_att_text(nc, lon, "units", std::strlen(l.lon_units), l.lon_units));
    }
    const int order[2] = {dims[l.transposed ? 1 : 0], dims[l.transposed ? 0 : 1]};
    Ok(nc_def_var(nc, l.name, l.type, 2, order, &var));
    if (l.packed) {
      Ok(nc_put_att_double(nc, var, "scale_factor", NC_DOUBLE, 1, &l.scale));
      Ok(nc_put_att_double(nc, var, "add_offset", NC_DOUBLE, 1, &l.offset));
    }
    if (l.has_fill) Ok(nc_put_att_double(nc, var, "_FillValue", l.type, 1, &l.fill));
    const std::string positive = l.sign < 0.0 ? "down" : l.positive;
    if (!positive.empty()) {
      Ok(nc_put_att_text(nc, var, "positive", positive.size(), positive.data()));
    }
    if (!l.units.empty()) Ok(nc_put_att_text(nc, var, "units", l.units.size(), l.units.data()));
    Ok(nc_enddef(nc));
    std::vector<double> lats, lons, values;
    for (int r = 0; r < l.rows; ++r) {
      lats.push_back(20.0 + (l.descending ? l.rows - 1 - r : r) + (l.uneven && r == 2 ? 0.3 : 0.0));
    }
    for (int c = 0; c < l.columns; ++c) lons.push_back(120.0 + l.lon_step * c);
    for (int i = 0; i < l.rows * l.columns; ++i) {
      const int r = l.transposed ? i % l.rows : i / l.columns;
      const int c = l.transposed ? i / l.rows : i % l.columns;
      const double raw = l.value(l.descending ? l.rows - 1 - r : r, c);
      values.push_back(l.has_fill && raw == l.fill ? raw : (l.sign * raw - l.offset) / l.scale);
    }
    if (l.coordinates) {
      Ok(nc_put_var_double(nc, lat, lats.data()));
      Ok(nc_put_var_double(nc, lon, lons.data()));
    }
    Ok(nc_put_var_double(nc, var, values.data()));
    Ok(nc_close(nc));
  }
  std::string Refusal() const {
    try {
      Bathymetry::Load(file_);
    } catch (const UserError& e) {
      return e.what();
    }
    return "accepted";
  }
  std::string Refusal(const Layout& l) const {
    Write(l);
    return Refusal();
  }

  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
  std::string file_;
};

double Plane(double lat, double lon) { return 10.0 * lat - 20.0 * lon + 2000.0; }

TEST_F(GridFile, EveryLayoutHoldsTheSamePlane) {
  std::vector<Layout> layouts(8);
  layouts[1].format = NC_NETCDF4;
  layouts[2].descending = true;
  layouts[3].transposed = true;
  layouts[4].transposed = layouts[4].descending = true;
  layouts[4].type = NC_FLOAT;
  layouts[5].packed = true;
  layouts[5].scale = 0.5;
  layouts[5].offset = -100.0;
  layouts[5].has_fill = true;
  layouts[5].fill = 32767.0;
  layouts[6].name = "ROSE";
  layouts[6].lat = "ETOPO05_Y";
  layouts[6].lon = "ETOPO05_X";
  layouts[6].type = NC_FLOAT;
  layouts[7].lat_units = layouts[7].lon_units = "";
  layouts[7].sign = -1.0;
  layouts[7].name = "depth";
  for (size_t k = 0; k < layouts.size(); ++k) {
    Write(layouts[k]);
    const Bathymetry grid = Bathymetry::Load(file_);
    ASSERT_EQ(grid.latitudes().size(), 5u);
    EXPECT_EQ(grid.latitudes().front(), 20.0);
    for (const double lat : {20.0, 21.25, 23.999, 24.0}) {
      for (const double lon : {120.0, 122.6, 126.0}) {
        EXPECT_NEAR(grid.At(lat, lon), Plane(lat, lon), 1e-3) << "layout " << k;
      }
    }
    const Bathymetry part = Bathymetry::Load(file_, {21.2, 22.5, 121.6, 122.9});
    EXPECT_EQ(part.latitudes(), (std::vector<double>{21.0, 22.0, 23.0})) << "layout " << k;
    EXPECT_EQ(part.longitudes(), (std::vector<double>{121.0, 122.0, 123.0}));
    EXPECT_NEAR(part.At(22.1, 121.7), Plane(22.1, 121.7), 1e-3);
    // The same longitude, less a full turn.
    EXPECT_NEAR(part.At(22.1, 121.7 - 360.0), Plane(22.1, 121.7), 1e-3);
    EXPECT_NEAR(Bathymetry::Load(file_, {21.2, 22.5, -238.4, -237.1}).At(22.0, -238.0),
                Plane(22.0, 122.0), 1e-3);
  }
}

TEST_F(GridFile, IsBilinearBetweenItsPoints) {
  const Bathymetry grid({0.0, 1.0}, {10.0, 11.0}, {0.0F, 100.0F, 200.0F, -500.0F});
  EXPECT_EQ(grid.At(0.0, 10.0), 0.0);
  EXPECT_EQ(grid.At(1.0, 11.0), -500.0);
  EXPECT_NEAR(grid.At(0.5, 10.5), 0.25 * (100.0 + 200.0 - 500.0), 1e-12);
  EXPECT_NEAR(grid.At(0.25, 10.75), 0.75 * 75.0 + 0.25 * (0.25 * 200.0 - 0.75 * 500.0), 1e-12);
  EXPECT_THROW(grid.At(1.01, 10.5), UserError);
  EXPECT_THROW(grid.At(0.5, 9.99), UserError);
  EXPECT_EQ(grid.lowest(), -500.0);
  EXPECT_EQ(grid.highest(), 200.0);
}

TEST(LevelGround, IsAsDeepBetweenThePointsAsAtThem) {
  const Bathymetry grid({0.0, 1.0}, {10.0, 11.0}, {-3856.0F, -3856.0F, -3856.0F, -3856.0F});
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) EXPECT_EQ(grid.At(0.01 * i, 10.0 + 0.01 * j), -3856.0);
  }
}

TEST_F(GridFile, SavedCropsAreReadBack) {
  Layout l;
  l.type = NC_FLOAT;
  Write(l);
  const Bathymetry part = Bathymetry::Load(file_, {21.0, 23.0, 121.0, 124.0});
  part.Save(folder_ + "/crop.nc", "for a test");
  const Bathymetry again = Bathymetry::Load(folder_ + "/crop.nc");
  EXPECT_EQ(again.latitudes(), part.latitudes());
  EXPECT_EQ(again.longitudes(), part.longitudes());
  EXPECT_EQ(again.At(22.0, 122.0), part.At(22.0, 122.0));
  EXPECT_THROW(part.Save(folder_ + "/no/such/folder.nc", ""), UserError);
}

TEST_F(GridFile, SaysWhatIsWrongWithAFile) {
  const auto says = [](const std::string& message, const char* what) {
    EXPECT_NE(message.find(what), std::string::npos) << message;
  };
  says(Refusal(), "no such file");
  std::ofstream(file_) << "";
  says(Refusal(), "is empty");
  std::ofstream(file_) << "lat,lon,elevation\n1,2,3\n";
  says(Refusal(), "not a readable NetCDF file");
  // The file ends soon after its header.
  Write(Layout());
  fs::resize_file(file_, fs::file_size(file_) - 60);
  says(Refusal(), "damaged");
  // The header promises more than the file holds: the number of dimensions, then the length of the
  // first one's name. libnetcdf would take memory for them before it reads.
  for (const int at : {12, 16}) {
    Write(Layout());
    std::fstream(file_, std::ios::in | std::ios::out | std::ios::binary)
        .seekp(at)
        .write("\x7f\xff\xff\xf0", 4);
    says(Refusal(), "its header does not fit the file");
  }
  Write(Layout());
  fs::resize_file(file_, 30);
  says(Refusal(), "its header does not fit the file");
  Layout l;
  l.coordinates = false;
  says(Refusal(l), "has no coordinates");
  l = Layout();
  l.uneven = true;
  says(Refusal(l), "not evenly spaced");
  l = Layout();
  l.lon_step = 1e-12;
  says(Refusal(l), "the points of lon are closer than");
  l = Layout();
  l.rows = 1;
  says(Refusal(l), "fewer than two points");
  l = Layout();
  l.lat_units = "degrees_east";
  l.lat = "a";
  says(Refusal(l), "does not lie over latitude and longitude");
  l = Layout();
  l.lat_units = "m";
  l.lat = "northing";
  says(Refusal(l), "neither latitude nor longitude");
  l = Layout();
  l.has_fill = true;
  l.fill = 32767.0;
  l.value = [](int, int) { return 32767.0; };
  says(Refusal(l), "all elevations there are missing");
  l.value = [](int row, int column) { return row == 1 && column == 1 ? 32767.0 : -50.0; };
  says(Refusal(l), "1 of 35 elevations there are missing");
  l = Layout();
  for (const double nowhere : {20000.0, 9500.0, -13000.0}) {
    l.value = [nowhere](int, int) { return nowhere; };
    says(Refusal(l), "does not exist on Earth");
  }
  for (const char* units : {"feet", "ft", "km", "cm", "fathoms"}) {
    l = Layout();
    l.units = units;
    says(Refusal(l), ("is in '" + std::string(units) + "'; convert it to metres").c_str());
  }
  l = Layout();
  l.positive = "sideways";
  says(Refusal(l), "positive = 'sideways', which is neither up nor down");
  l = Layout();
  l.type = NC_FLOAT;
  l.value = [](int, int) { return std::nan(""); };
  says(Refusal(l), "all elevations there are missing");
  Write(Layout());
  EXPECT_THROW(Bathymetry::Load(file_, {19.0, 21.0, 121.0, 122.0}), UserError);
  EXPECT_THROW(Bathymetry::Load(file_, {21.0, 22.0, 125.0, 127.0}), UserError);
  EXPECT_THROW(Bathymetry::Load(file_, {22.0, 21.0, 121.0, 122.0}), UserError);
}

TEST_F(GridFile, RefusesOnesOfOtherDimensionsOrWithoutElevations) {
  const auto write = [this](int dimensions, int variables) {
    int nc = 0, dims[3] = {}, var = 0;
    Ok(nc_create(file_.c_str(), NC_CLOBBER, &nc));
    const char* const names[] = {"lat", "lon", "time"};
    for (int k = 0; k < dimensions; ++k) Ok(nc_def_dim(nc, names[k], 3, &dims[k]));
    for (int v = 0; v < variables; ++v) {
      Ok(nc_def_var(nc, ("field" + std::to_string(v)).c_str(), NC_FLOAT, dimensions, dims, &var));
    }
    Ok(nc_close(nc));
  };
  write(3, 1);
  EXPECT_NE(Refusal().find("no variable over latitude and longitude; its variables are field0"),
            std::string::npos);
  write(1, 1);
  EXPECT_NE(Refusal().find("no variable"), std::string::npos);
  write(0, 0);
  EXPECT_NE(Refusal().find("it has no variables"), std::string::npos);
  write(2, 2);
  EXPECT_NE(Refusal().find("several variables could be elevations"), std::string::npos);
}

TEST_F(GridFile, FilesOfBothFormatsThatAreCutOffAnywhereAreRefused) {
  for (const int format : {NC_CLASSIC_MODEL, NC_64BIT_OFFSET, NC_64BIT_DATA, NC_NETCDF4}) {
    Layout l;
    l.format = format;
    Write(l);
    const auto whole = fs::file_size(file_);
    EXPECT_EQ(Refusal(), "accepted");
    // A NetCDF 4 file may have an unused end.
    const auto slack = format == NC_NETCDF4 ? whole / 3 : 4;
    for (auto size = whole - slack; size > 8; size = size * 4 / 5) {
      Write(l);
      fs::resize_file(file_, size);
      EXPECT_NE(Refusal(), "accepted") << format << ": " << size << " of " << whole;
    }
  }
}

TEST(ShippedBathymetry, CoversTheBoxOfThePapersFigure6) {
  const Bathymetry grid = Bathymetry::Load(STG_SHIPPED_TERRAIN "/fig6.nc");
  for (const double lat : {21.2, 22.5}) {
    for (const double lon : {121.6, 122.9}) EXPECT_TRUE(grid.Covers(lat, lon));
  }
  EXPECT_LT(grid.highest(), -100.0);
  EXPECT_NEAR(grid.lowest(), -5288.0, 0.5);
}

TEST(ShippedBathymetry, ManyThreadsReadItAtOnce) {
  std::vector<std::thread> threads;
  for (int k = 0; k < 8; ++k) {
    threads.emplace_back([] {
      for (int i = 0; i < 10; ++i) {
        EXPECT_NO_THROW(Bathymetry::Load(STG_SHIPPED_TERRAIN "/fig6.nc"));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST_F(GridFile, AHugeGridIsRefusedAtOnceAndCroppedWithoutReadingIt) {
  // A grid of the world at 1/60 degree. Its values are never written, so the classic file has
  // holes.
  int nc = 0, dims[2] = {}, lat = 0, lon = 0, var = 0;
  const size_t rows = 10801, columns = 21601;
  Ok(nc_create(file_.c_str(), NC_CLOBBER | NC_64BIT_OFFSET, &nc));
  Ok(nc_def_dim(nc, "lat", rows, &dims[0]));
  Ok(nc_def_dim(nc, "lon", columns, &dims[1]));
  Ok(nc_def_var(nc, "lat", NC_DOUBLE, 1, &dims[0], &lat));
  Ok(nc_def_var(nc, "lon", NC_DOUBLE, 1, &dims[1], &lon));
  Ok(nc_def_var(nc, "z", NC_SHORT, 2, dims, &var));
  int old = 0;
  Ok(nc_set_fill(nc, NC_NOFILL, &old));
  Ok(nc_enddef(nc));
  std::vector<double> lats, lons;
  for (size_t k = 0; k < rows; ++k) lats.push_back(-90.0 + static_cast<double>(k) / 60.0);
  for (size_t k = 0; k < columns; ++k) lons.push_back(-180.0 + static_cast<double>(k) / 60.0);
  Ok(nc_put_var_double(nc, lat, lats.data()));
  Ok(nc_put_var_double(nc, lon, lons.data()));
  const size_t start[2] = {6600, 18000}, count[2] = {200, 200};
  const std::vector<short> part(200 * 200, -777);
  Ok(nc_put_vara_short(nc, var, start, count, part.data()));
  Ok(nc_close(nc));
  EXPECT_NE(Refusal().find("too many: crop a region of it"), std::string::npos);
  const Bathymetry crop = Bathymetry::Load(file_, {20.5, 21.5, 120.5, 121.5});
  EXPECT_EQ(crop.latitudes().size(), 61u);
  EXPECT_EQ(crop.At(21.0, 121.0), -777.0);
}

}  // namespace
}  // namespace stg::dynamics

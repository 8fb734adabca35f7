// Crops of a bathymetry file, and the files that they must not destroy.

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "auv_dynamics/terrain/bathymetry.hpp"

namespace stg::dynamics {
namespace {

namespace fs = std::filesystem;

class Crop : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ = folder_ + "/grid.nc";
    fs::copy_file(STG_SHIPPED_TERRAIN "/fig6.nc", file_);
  }

  /// Runs the tool, which writes the file `out` and prints into `result`. True if it succeeded.
  bool Tool(const std::string& out, const std::string& result = "/dev/null") const {
    const std::string command = "'" STG_CROP_TERRAIN "' '" + file_ + "' --out '" + out + "' > '" +
                                result + "' 2> /dev/null";
    return std::system(command.c_str()) == 0;
  }

  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
  std::string file_;
};

TEST_F(Crop, APipeIsNotReplacedAndAFileNotByHalfOfOne) {
  const Bathymetry grid = Bathymetry::Load(file_);
  const std::string pipe = folder_ + "/pipe.nc", old = folder_ + "/old.nc";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(grid.Save(pipe, ""), UserError);
  EXPECT_TRUE(fs::is_fifo(pipe));
  std::ofstream(old) << "old";
  fs::create_directory(old + ".tmp");  // the temporary file cannot be created
  EXPECT_THROW(grid.Save(old, ""), UserError);
  EXPECT_EQ(fs::file_size(old), 3u);
  fs::remove(old + ".tmp");
  grid.Save(old, "");
  EXPECT_EQ(Bathymetry::Load(old).lowest(), grid.lowest());
  EXPECT_FALSE(fs::exists(old + ".tmp"));
}

TEST_F(Crop, TheToolDoesNotWriteOverItsInputByAnotherName) {
  fs::create_symlink(file_, folder_ + "/link.nc");
  const auto before = fs::last_write_time(file_);
  for (const char* name : {"/grid.nc", "/link.nc", "/./grid.nc"}) {
    EXPECT_FALSE(Tool(folder_ + name)) << name;
  }
  EXPECT_EQ(fs::last_write_time(file_), before);
  EXPECT_TRUE(Tool(folder_ + "/copy.nc"));
  EXPECT_TRUE(Tool(folder_ + "/\xe9.nc")) << "a name that is no UTF-8";
  EXPECT_FALSE(Tool(folder_ + "/unseen.nc", "/dev/full"));
}

}  // namespace
}  // namespace stg::dynamics

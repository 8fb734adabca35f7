#include "auv_common/durable_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"

namespace stg {
namespace {

namespace fs = std::filesystem;

class DurableFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = folder_ + "/file";
    std::ofstream(path_) << "old";
  }

  /// Writes "new" to `path`. Returns the end of the error message; "" if the file was written.
  std::string Refusal(const std::string& path) const {
    const std::string start = path + ": cannot write the table: ";
    try {
      WriteDurably("new", path, "the table");
    } catch (const UserError& error) {
      EXPECT_EQ(std::string(error.what()).rfind(start, 0), 0U) << error.what();
      return std::string(error.what()).substr(start.size());
    }
    return "";
  }
  static std::string Read(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }

  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path().string();
  std::string path_;
};

TEST_F(DurableFileTest, TheNewFileTakesTheOldOnesPlaceAndNothingElseIsLeft) {
  EXPECT_EQ(Refusal(path_), "");
  EXPECT_EQ(Read(path_), "new");
  EXPECT_EQ(Refusal(folder_ + "/another"), "");
  EXPECT_EQ(Read(folder_ + "/another"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2);
}

TEST_F(DurableFileTest, AFullDiskLeavesTheOldFile) {
  fs::create_symlink("/dev/full", path_ + ".tmp");
  EXPECT_EQ(Refusal(path_), "No space left on device");
  EXPECT_EQ(Read(path_), "old");
  EXPECT_FALSE(fs::is_symlink(path_ + ".tmp"));
}

TEST_F(DurableFileTest, WhatIsWrittenByOthersCountsOnceItIsCommitted) {
  {
    DurableFile file(path_, "the table");
    std::ofstream(file.temporary()) << "half";
    EXPECT_EQ(Read(path_), "old");
  }
  EXPECT_FALSE(fs::exists(path_ + ".tmp"));
  EXPECT_EQ(Read(path_), "old");
  DurableFile file(path_, "the table");
  std::ofstream(file.temporary()) << "whole";
  file.Commit();
  EXPECT_EQ(Read(path_), "whole");
  EXPECT_THROW(file.Commit(), UserError);  // nothing was written since the first commit
  EXPECT_EQ(Read(path_), "whole");
}

TEST_F(DurableFileTest, WhatIsNoFileIsNotReplacedByOne) {
  ASSERT_EQ(::mkfifo((folder_ + "/pipe").c_str(), 0600), 0);
  fs::create_symlink("/dev/null", folder_ + "/device");
  EXPECT_EQ(Refusal(folder_ + "/pipe"), "not a regular file");
  EXPECT_EQ(Refusal(folder_ + "/device"), "not a regular file");
  EXPECT_EQ(Refusal(folder_), "is a directory");
  EXPECT_EQ(Refusal(folder_ + "/none/file"), "No such file or directory");
  EXPECT_EQ(Refusal(path_ + "/file"), "Not a directory");
  EXPECT_TRUE(fs::is_fifo(folder_ + "/pipe"));
  EXPECT_TRUE(fs::is_symlink(folder_ + "/device"));
}

TEST_F(DurableFileTest, ALinkGoesOnLeadingToTheFile) {
  fs::create_directory(folder_ + "/elsewhere");
  fs::create_symlink("../file", folder_ + "/elsewhere/link");
  EXPECT_EQ(Refusal(folder_ + "/elsewhere/link"), "");
  EXPECT_TRUE(fs::is_symlink(folder_ + "/elsewhere/link"));
  EXPECT_EQ(Read(path_), "new");
}

}  // namespace
}  // namespace stg

#include "auv_common/regular_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"

namespace stg {
namespace {

namespace fs = std::filesystem;

class RegularFile : public ::testing::Test {
 protected:
  std::string Refusal(const std::string& name) const {
    const std::string path = folder_ + "/" + name;
    try {
      RequireRegularFile(path, 3);
    } catch (const UserError& e) {
      return std::string(e.what()).substr(path.size());
    }
    return "";
  }

  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
};

TEST_F(RegularFile, WhatIsNoneIsToldByItsKindAndNotOpened) {
  std::ofstream(folder_ + "/small") << "abc";
  std::ofstream(folder_ + "/large") << "abcd";
  fs::create_symlink("small", folder_ + "/link");
  fs::create_symlink("loop", folder_ + "/loop");
  fs::create_directory(folder_ + "/folder");
  ASSERT_EQ(::mkfifo((folder_ + "/pipe").c_str(), 0600), 0);
  EXPECT_EQ(Refusal("small"), "");
  EXPECT_EQ(Refusal("link"), "");
  EXPECT_EQ(Refusal("none"), ": no such file");
  EXPECT_EQ(Refusal("folder"), ": is a directory, not a file");
  EXPECT_EQ(Refusal("pipe"), ": not a regular file");
  EXPECT_EQ(Refusal("loop"), ": Too many levels of symbolic links");
  EXPECT_EQ(Refusal("small/x"), ": no such file");
  EXPECT_EQ(Refusal("large"), ": larger than 3 bytes, refused before reading");
}

TEST_F(RegularFile, AByteOrderMarkIsNoPartOfAText) {
  const std::string mark = "\xEF\xBB\xBF", path = folder_ + "/text";
  const auto read = [&](const std::string& bytes) {
    std::ofstream(path) << bytes;
    std::ifstream in = OpenText(path);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  for (const std::string& text : {std::string(), std::string("a"), std::string("t,x\n1,2\n")}) {
    EXPECT_EQ(read(text), text);
    EXPECT_EQ(read(mark + text), text);
    EXPECT_EQ(read(mark + mark + text), mark + text);
    EXPECT_EQ(read(text + mark), text.empty() ? "" : text + mark);
  }
  EXPECT_EQ(read("\xEF\xBB"), "\xEF\xBB");
  EXPECT_THROW(OpenText(path, 1), UserError);
  EXPECT_THROW(OpenText(folder_), UserError);
}

}  // namespace
}  // namespace stg

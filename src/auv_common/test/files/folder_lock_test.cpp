#include "auv_common/folder_lock.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <optional>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"

namespace stg {
namespace {

class FolderLockTest : public ::testing::Test {
 protected:
  /// The message with which a lock of the folder is refused; "" if the lock was taken.
  std::string Refusal() const {
    try {
      FolderLock lock(folder_);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }

  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path().string();
};

TEST_F(FolderLockTest, OneAtATimeHasTheFolder) {
  {
    const FolderLock first(folder_);
    EXPECT_EQ(Refusal(), folder_ + ": another program is writing into it");
  }
  EXPECT_EQ(Refusal(), "");
}

TEST_F(FolderLockTest, AProgramThatIsKilledLeavesNoLock) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const FolderLock lock(folder_);
    if (::write(ready[1], "x", 1) == 1) ::pause();
    ::_exit(1);
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_NE(Refusal(), "");
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(Refusal(), "");
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_F(FolderLockTest, WhatCannotBeLockedIsNamed) {
  std::filesystem::create_directory(folder_ + "/.lock");
  EXPECT_EQ(Refusal(), folder_ + "/.lock: cannot be locked: Is a directory");
}

}  // namespace
}  // namespace stg

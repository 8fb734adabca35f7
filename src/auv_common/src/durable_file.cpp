#include "auv_common/durable_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "auv_common/error.hpp"

namespace stg {
namespace {

namespace fs = std::filesystem;

std::string FolderOf(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

/// Returns 0, or the error code if not all bytes were written.
int WriteAll(int file, const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = ::write(file, bytes.data() + at, bytes.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    at += static_cast<std::size_t>(n);
  }
  return 0;
}

/// Returns 0, or the error code if a file or folder is not on disk.
int Sync(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return errno;
  const int error = ::fsync(file) == 0 ? 0 : errno;
  ::close(file);
  return error;
}

}  // namespace

DurableFile::DurableFile(std::string path, std::string what)
    : path_(std::move(path)), what_(std::move(what)), place_(path_) {
  std::error_code error;
  const fs::file_status status = fs::status(path_, error);
  if (fs::is_directory(status)) Fail("is a directory");
  if (fs::exists(status) && !fs::is_regular_file(status)) Fail("not a regular file");
  if (fs::is_regular_file(status) && fs::is_symlink(path_, error)) {
    place_ = fs::canonical(path_, error).string();
    if (error) Fail(error.message());
  }
  temporary_ = place_ + ".tmp";
  // With a slash, so that a file in place of the folder gives the right error.
  if (::access((FolderOf(place_) + "/").c_str(), W_OK | X_OK) != 0) Fail(std::strerror(errno));
}

DurableFile::~DurableFile() { ::unlink(temporary_.c_str()); }  // does nothing after Commit

void DurableFile::Commit() {
  const int error = Sync(temporary_);
  if (error != 0) Fail(std::strerror(error));
  if (std::rename(temporary_.c_str(), place_.c_str()) != 0) Fail(std::strerror(errno));
  Sync(FolderOf(place_));  // useful but not required; some file systems cannot do it
}

void DurableFile::Write(const std::string& bytes) {
  const int file = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) Fail(std::strerror(errno));
  int error = WriteAll(file, bytes);
  if (::close(file) != 0 && error == 0) error = errno;
  if (error != 0) Fail(std::strerror(error));
  Commit();
}

void DurableFile::Fail(const std::string& reason) const {
  throw UserError(path_ + ": cannot write " + what_ + ": " + reason);
}

void WriteDurably(const std::string& bytes, const std::string& path, const std::string& what) {
  DurableFile(path, what).Write(bytes);
}

}  // namespace stg

#include "target.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "auv_common/error.hpp"

namespace stg::fuzz {
namespace {

/// A file that has no name on any disk.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& bytes) : file_(::memfd_create("input", MFD_CLOEXEC)) {
    for (std::size_t at = 0; file_ >= 0 && at < bytes.size();) {
      const ssize_t n = ::write(file_, bytes.data() + at, bytes.size() - at);
      if (n <= 0) throw std::runtime_error(std::string("memfd: ") + std::strerror(errno));
      at += static_cast<std::size_t>(n);
    }
    if (file_ < 0) throw std::runtime_error(std::string("memfd: ") + std::strerror(errno));
  }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

}  // namespace

bool LoadAsFile(const std::string& bytes, const std::function<void(const std::string&)>& load) {
  const MemoryFile file(bytes);
  try {
    load(file.path());
    return true;
  } catch (const UserError&) {
    return false;
  }
}

void Require(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "fuzz: %s\n", what);
  std::abort();
}

void Bytes::TakeInto(void* value, std::size_t size) {
  const std::size_t n = std::min(size, bytes_.size() - std::min(at_, bytes_.size()));
  if (n > 0) std::memcpy(value, bytes_.data() + at_, n);
  at_ += size;
}

}  // namespace stg::fuzz

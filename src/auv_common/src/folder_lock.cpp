#include "auv_common/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "auv_common/error.hpp"

namespace stg {

FolderLock::FolderLock(const std::string& folder) {
  const std::string path = folder + "/.lock";
  // Opened for writing, because a lock on NFS needs it.
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file_ >= 0 && ::flock(file_, LOCK_EX | LOCK_NB) == 0) return;
  const int reason = errno;
  if (file_ >= 0) ::close(file_);
  if (reason == EWOULDBLOCK) throw UserError(folder + ": another program is writing into it");
  throw UserError(path + ": cannot be locked: " + std::strerror(reason));
}

FolderLock::~FolderLock() { ::close(file_); }

}  // namespace stg

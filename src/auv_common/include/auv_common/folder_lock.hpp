#pragma once

#include <string>

namespace stg {

/// Locks a folder as long as this object lives. It keeps out other programs that use the same lock:
/// flock on the file .lock in the folder. The kernel releases the lock when the program ends, in
/// whatever way. The empty file stays.
class FolderLock {
 public:
  /// Throws UserError if another program has the lock, or if the file cannot be made or locked.
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_;
};

}  // namespace stg

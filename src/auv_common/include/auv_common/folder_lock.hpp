#pragma once

#include <string>

namespace stg {

/// Keeps other programs that take it too out of a folder, as long as it lives: flock on the file
/// .lock in it, which the kernel lets go of however the program ends. The empty file stays.
class FolderLock {
 public:
  /// UserError when another program has the folder, or the file cannot be made or locked.
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_;
};

}  // namespace stg

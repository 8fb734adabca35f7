#pragma once

#include <string>

namespace stg {

/// Replaces a file by a complete new one. The new file is written beside the old one, synced to
/// disk and renamed. So a full disk, a crash or a signal leaves the old file or the new one, never
/// a part of one. If the path is a link, the file that it points to is replaced.
///
/// Limits: it does not keep two writers of one path apart, because both use temporary() (FolderLock
/// does). It does not keep owner and mode of the old file; the new one has those of any new file.
/// It does not change several files together. A program that is killed leaves temporary() behind;
/// the next write replaces it.
class DurableFile {
 public:
  /// Writes nothing yet. Throws UserError if the folder cannot be written, or if the path is
  /// something other than a regular file: a pipe or a device must not be replaced by a file.
  /// @param what content of the file, e.g. "the table", for messages "PATH: cannot write WHAT:
  /// reason"
  DurableFile(std::string path, std::string what);
  /// Removes data that was written and not committed.
  ~DurableFile();
  DurableFile(const DurableFile&) = delete;
  DurableFile& operator=(const DurableFile&) = delete;

  /// The path to write to before Commit: the path of the file and ".tmp".
  const std::string& temporary() const { return temporary_; }
  /// Replaces the file by temporary(), which must be written and closed. Throws UserError if this
  /// fails or if the data does not reach the disk; the old file is then still there.
  void Commit();
  /// Writes and commits these bytes.
  void Write(const std::string& bytes);
  /// Throws the UserError for a caller that failed to write temporary().
  [[noreturn]] void Fail(const std::string& reason) const;

 private:
  std::string path_, what_, place_, temporary_;
};

/// DurableFile(path, what).Write(bytes).
void WriteDurably(const std::string& bytes, const std::string& path, const std::string& what);

}  // namespace stg

#pragma once

#include <string>

namespace stg {

/// A file that takes the place of another one when it is whole: it is written beside it, synced to
/// disk and renamed, so that a full disk, a crash or a signal meanwhile leaves the old file or the
/// new one, never a part of it. A link to a file is followed.
///
/// What it does not do: keep writers of one path apart, which share temporary() (FolderLock does);
/// keep the old one's owner and mode, the new one has those of any new file; have several files
/// change together. A program that is killed leaves temporary() behind, until the next one.
class DurableFile {
 public:
  /// Writes nothing yet, but throws UserError where the folder cannot be written, and for what is
  /// there and no regular file: a pipe or a device is not to be replaced by one.
  /// @param what is in the file, for messages, "PATH: cannot write WHAT: reason": "the table".
  DurableFile(std::string path, std::string what);
  /// Removes what was written and not committed.
  ~DurableFile();
  DurableFile(const DurableFile&) = delete;
  DurableFile& operator=(const DurableFile&) = delete;

  /// Where to write what Commit takes: the path and ".tmp".
  const std::string& temporary() const { return temporary_; }
  /// What was written into temporary(), and closed, takes its place. UserError when it does not, or
  /// was not brought to disk; the old file is there still.
  void Commit();
  /// Writes and commits these bytes.
  void Write(const std::string& bytes);
  /// Throws the UserError of a caller that wrote into temporary().
  [[noreturn]] void Fail(const std::string& reason) const;

 private:
  std::string path_, what_, place_, temporary_;
};

/// DurableFile(path, what).Write(bytes).
void WriteDurably(const std::string& bytes, const std::string& path, const std::string& what);

}  // namespace stg

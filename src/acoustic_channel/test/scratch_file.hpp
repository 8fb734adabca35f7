#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

namespace stg::acoustics {

/// A file of this process alone, for one test. The end of the object removes it.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& text, const std::string& ending = ".yaml")
      : path_(testing::TempDir() + "/scratch_XXXXXX" + ending) {
    const int file = mkstemps(path_.data(), static_cast<int>(ending.size()));
    if (file < 0) throw std::runtime_error(path_ + ": cannot be created");
    close(file);
    std::ofstream(path_) << text;
  }
  ~ScratchFile() { std::remove(path_.c_str()); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace stg::acoustics

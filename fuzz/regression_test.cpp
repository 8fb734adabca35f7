// Every initial input of the fuzzers, and every input that found a bug, must be refused or accepted
// as its name says.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "target.hpp"

namespace stg::fuzz {
namespace {

namespace fs = std::filesystem;

class Fuzz : public ::testing::TestWithParam<Target> {
 protected:
  static void SetUpTestSuite() { setenv("STG_SCENARIOS", STG_SCENARIOS, 1); }
};

/// Runs the files of a folder. Returns their number.
int RunFolder(const fs::path& folder, const Target& target) {
  int count = 0;
  if (!fs::exists(folder)) return 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path());
    std::ifstream in(entry.path(), std::ios::binary);
    std::stringstream bytes;
    bytes << in.rdbuf();
    bool accepted = false;
    EXPECT_NO_THROW(accepted = target.run(bytes.str()));
    // The name of the file states the expected result.
    const std::string name = entry.path().filename().string();
    const bool good = name.rfind("good_", 0) == 0, bad = name.rfind("bad_", 0) == 0;
    EXPECT_TRUE(good || bad) << "is neither good_* nor bad_*";
    EXPECT_EQ(accepted, good);
    ++count;
  }
  return count;
}

TEST_P(Fuzz, StartingInputsAreTaken) {
  EXPECT_GT(RunFolder(fs::path(STG_FUZZ) / "corpus" / GetParam().name, GetParam()), 0);
}

TEST_P(Fuzz, WhatWasFoundIsFoundNoMore) {
  RunFolder(fs::path(STG_FUZZ) / "regressions" / GetParam().name, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz, ::testing::ValuesIn(kTargets),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace stg::fuzz

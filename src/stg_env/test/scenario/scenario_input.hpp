#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::scenario_test {

namespace fs = std::filesystem;

/// The message of the UserError that `call` throws. It is a failure if `call` throws none.
template <class F>
std::string ErrorOf(F call) {
  try {
    call();
  } catch (const UserError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no UserError";
  return "";
}

/// Each test has its own folder with files that it writes.
class ScenarioFolder : public ::testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

/// Tests that replace one line of a scenario file.
class ScenarioInput : public ScenarioFolder {
 protected:
  /// The whole file with the line of `key` (its leaf) replaced. Sets `line` to the number of that
  /// line.
  static std::string WithLine(const std::string& key, const std::string& replacement, int* line) {
    std::istringstream in(ToYaml(Scenario{}));
    std::string out;
    int number = 0;
    *line = 0;
    for (std::string text; std::getline(in, text);) {
      ++number;
      const auto start = text.find_first_not_of(' ');
      if (*line == 0 && text.compare(start, key.size() + 1, key + ":") == 0) {
        *line = number;
        text = text.substr(0, start) + replacement;
      }
      out += text + "\n";
    }
    EXPECT_GT(*line, 0) << key;
    return out;
  }

  /// Loads the file with one line replaced. Expects an error that names file, line and key, and
  /// says `what`.
  void ExpectRefused(const std::string& leaf, const std::string& replacement,
                     const std::string& path, const std::string& what) {
    int line = 0;
    const std::string file = Write("bad.yaml", WithLine(leaf, replacement, &line));
    const std::string message = ErrorOf([&] { LoadScenario(file); });
    const std::string start = file + ":" + std::to_string(line) + ": " + path + ": ";
    EXPECT_EQ(message.substr(0, start.size()), start) << replacement;
    EXPECT_NE(message.find(what), std::string::npos) << message << "\nexpected: " << what;
  }
};

}  // namespace stg::scenario_test

#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "auv_common/testing/temporary_folder.hpp"

/// Runs the programs as a user does.
namespace stg::env {

namespace fs = std::filesystem;

struct Result {
  int code = -1;
  std::string out, err;
  /// The object on the last line of stdout.
  nlohmann::json Json() const {
    std::istringstream in(out);
    std::string line, last;
    while (std::getline(in, line)) last = line;
    return nlohmann::json::parse(last, nullptr, false);
  }
};

class CommandLine : public ::testing::Test {
 protected:
  void SetUp() override { ::setenv("STG_SCENARIOS", STG_SCENARIO_FOLDER, 1); }

  Result Run(const std::string& program, const std::string& arguments) const {
    const std::string out = folder_ + "/stdout", err = folder_ + "/stderr";
    const int status = std::system(
        ("'" + program + "' " + arguments + " > '" + out + "' 2> '" + err + "'").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, Read(out), Read(err)};
  }
  static std::string Read(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
  std::string Scenario(const std::string& text) const {
    std::ofstream(folder_ + "/bad.yaml") << "base: " STG_SCENARIO_FOLDER "/medium.yaml\n" << text;
    return folder_ + "/bad.yaml";
  }

  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
};

}  // namespace stg::env

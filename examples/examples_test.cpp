#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

namespace {

/// The programs of this folder.
std::vector<std::string> Programs() {
  std::istringstream list(STG_EXAMPLES);
  std::vector<std::string> programs;
  for (std::string program; std::getline(list, program, ':');) programs.push_back(program);
  return programs;
}

class Examples : public testing::TestWithParam<std::string> {};

TEST_P(Examples, DoesWhatItShould) {
  // The environment variable gives the folder of the scenarios.
  const std::string command = "STG_SCENARIOS='" STG_SCENARIO_FOLDER "' '" + GetParam() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
}

std::string NameOf(const testing::TestParamInfo<std::string>& info) {
  return info.param.substr(info.param.rfind('/') + 1);
}
INSTANTIATE_TEST_SUITE_P(All, Examples, testing::ValuesIn(Programs()), NameOf);

}  // namespace

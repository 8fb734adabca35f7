#include "stg_env/env/trace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "env/env_fixture.hpp"

namespace stg::env {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> GoldenFolders() {
  std::vector<std::string> folders;
  for (const auto& entry : fs::directory_iterator(STG_TEST_DATA "/golden")) {
    if (entry.is_directory()) folders.push_back(entry.path().string());
  }
  return folders;
}

const Scenario& Release() {
  static const Scenario release = Shipped("medium_release");
  return release;
}

/// True for columns that drive the replay. The test does not compare them.
bool IsDriven(const std::string& column) {
  return column == "step" || column == "agent" || (column.size() == 2 && column[0] == 'a');
}

TEST(GoldenTrace, EveryOneIsReproducedInStateObservationAndReward) {
  const auto folders = GoldenFolders();
  ASSERT_GE(folders.size(), 3u);
  for (const std::string& folder : folders) {
    const Trace trace = LoadTrace(folder, Release());
    const TraceError e = ReplayTrace(trace, 1e-5);
    EXPECT_LE(e.max_abs_error, 1e-5)
        << folder << ": " << e.worst_column << ", step " << e.worst_step;
    EXPECT_EQ(e.first_bad_step, -1);
    EXPECT_EQ(e.steps * trace.scenario.run.agents, static_cast<int>(trace.rows.size()));
    for (const char* group : {"state", "angle", "target", "tau", "observation", "reward"}) {
      EXPECT_EQ(e.by_group.count(group), 1u) << folder << " " << group;
    }
    for (const std::string& c : trace.columns) {
      EXPECT_EQ(e.by_column.count(c), IsDriven(c) ? 0u : 1u) << c;
    }
  }
}

TEST(GoldenTrace, AChangeInAnyColumnIsFound) {
  for (const std::string& folder : GoldenFolders()) {
    const Trace good = LoadTrace(folder, Release());
    Trace bad = good;
    for (size_t c = 0; c < good.columns.size(); ++c) {
      if (!IsDriven(good.columns[c])) bad.rows[(11 + c) * 4 + c % 4][c] += 1e-3;
    }
    const TraceError e = ReplayTrace(bad, 1e-5);
    for (const std::string& name : good.columns) {
      if (IsDriven(name)) continue;
      EXPECT_NEAR(e.by_column.at(name), 1e-3, 2e-5) << name;
    }
  }
}

TEST(GoldenTrace, TheFirstAndTheWorstChangeAreLocated) {
  const Trace good = LoadTrace(GoldenFolders()[0], Release());
  const auto column = [&](const std::string& name) {
    return static_cast<size_t>(std::find(good.columns.begin(), good.columns.end(), name) -
                               good.columns.begin());
  };
  Trace bad = good;
  bad.rows[4 * 30 + 2][column("obs40")] += 1e-4;
  bad.rows[4 * 90 + 1][column("r_sem")] -= 1e-2;
  const TraceError e = ReplayTrace(bad, 1e-5);
  EXPECT_EQ(e.first_bad_step, 30);
  EXPECT_EQ(e.first_bad_column, "obs40");
  EXPECT_EQ(e.worst_step, 90);
  EXPECT_EQ(e.worst_agent, 1);
  EXPECT_EQ(e.worst_column, "r_sem");
  EXPECT_NEAR(e.max_abs_error, 1e-2, 1e-5);
  EXPECT_NEAR(e.by_group.at("observation"), 1e-4, 1e-5);
  EXPECT_LE(e.by_group.at("state"), 1e-5);
}

TEST(GoldenTrace, AnotherActionOrStartOrSettingIsFound) {
  double coriolis = 0.0;
  for (const std::string& folder : GoldenFolders()) {
    const Trace good = LoadTrace(folder, Release());
    Trace bad = good;
    ASSERT_EQ(bad.columns[2], "a0");
    bad.rows[4 * 20 + 1][2] = bad.rows[4 * 20 + 1][2] > 0.0 ? -0.9 : 0.9;
    EXPECT_EQ(ReplayTrace(bad, 1e-5).first_bad_step, 20);
    bad = good;
    bad.p_WT[0].y += 1e-4;
    EXPECT_EQ(ReplayTrace(bad, 1e-5).first_bad_step, 0);
    bad = good;
    bad.scenario.agent.observation.release_bookkeeping = false;
    EXPECT_GT(ReplayTrace(bad, 1e-5).by_group.at("observation"), 1e-5) << folder;
    bad = good;
    bad.scenario.world.vehicle.reversed_coriolis = false;
    coriolis = std::max(coriolis, ReplayTrace(bad, 1e-5).max_abs_error);
  }
  // Only the trace that turns its AUVs shows the sign error of the release.
  EXPECT_GT(coriolis, 1e-5);
}

TEST(GoldenTrace, AnEmptyCellIsNotCompared) {
  Trace trace = LoadTrace(GoldenFolders()[0], Release());
  trace.rows[40][8] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_LE(ReplayTrace(trace, 1e-5).max_abs_error, 1e-5);
}

/// A small copy of a golden trace, in its own folder, which a test spoils.
class BadTrace : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string source = STG_TEST_DATA "/golden/velocity_medium";
    config_ = Read(source + "/config.yaml");
    std::ifstream in(source + "/steps.csv");
    std::string line;
    for (int k = 0; k < 9 && std::getline(in, line); ++k) lines_.push_back(line);
    Write();
  }

  static std::string Read(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
  void Write() const {
    std::ofstream(folder_ + "/config.yaml") << config_;
    std::ofstream steps(folder_ + "/steps.csv");
    for (const std::string& line : lines_) steps << line << '\n';
  }
  void Replace(const std::string& from, const std::string& to) {
    const size_t at = config_.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    config_.replace(at, from.size(), to);
  }
  /// The message of the UserError from loading or replaying the trace.
  std::string Error() const {
    try {
      ReplayTrace(LoadTrace(folder_, Release()), 1e-5);
    } catch (const UserError& e) {
      return e.what();
    }
    return "no error";
  }
  void ExpectError(const std::string& place, const std::string& what) const {
    Write();
    const std::string message = Error();
    EXPECT_NE(message.find(folder_ + place), std::string::npos) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message;
  }
  /// Replaces cell `column` of line `line` (1: the header).
  void SetCell(size_t line, const std::string& column, const std::string& value) {
    std::vector<std::string> header = Cells(lines_[0]), cells = Cells(lines_[line - 1]);
    const auto at = std::find(header.begin(), header.end(), column) - header.begin();
    cells[static_cast<size_t>(at)] = value;
    std::string joined;
    for (const std::string& cell : cells) joined += (joined.empty() ? "" : ",") + cell;
    lines_[line - 1] = joined;
  }
  static std::vector<std::string> Cells(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    return cells;
  }

  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
  std::string config_;
  std::vector<std::string> lines_;
};

TEST_F(BadTrace, TheCopyItselfIsGood) {
  EXPECT_EQ(Error(), "no error");
  EXPECT_LE(ReplayTrace(LoadTrace(folder_, Release()), 1e-5).max_abs_error, 1e-5);
}

TEST_F(BadTrace, AByteOrderMarkBeforeEachFileIsHarmless) {
  config_.insert(0, "\xEF\xBB\xBF");
  lines_[0].insert(0, "\xEF\xBB\xBF");
  Write();
  const Trace trace = LoadTrace(folder_, Release());
  EXPECT_EQ(trace.columns[0], Cells(Read(STG_TEST_DATA "/golden/velocity_medium/steps.csv"))[0]);
  EXPECT_LE(ReplayTrace(trace, 1e-5).max_abs_error, 1e-5);
}

TEST_F(BadTrace, MissingFolderAndFilesAreNamed) {
  fs::remove(folder_ + "/steps.csv");
  EXPECT_EQ(Error(), folder_ + "/steps.csv: no such file");
  fs::remove(folder_ + "/config.yaml");
  EXPECT_EQ(Error(), folder_ + "/config.yaml: no such file");
  fs::create_directory(folder_ + "/config.yaml");
  EXPECT_EQ(Error(), folder_ + "/config.yaml: is a directory, not a file");
}

TEST_F(BadTrace, EmptyFilesAreRefused) {
  const std::string config = config_;
  config_.clear();
  ExpectError("/config.yaml:1", "map");
  config_ = config;
  lines_.clear();
  ExpectError("/steps.csv:", "whole number of steps");
}

TEST_F(BadTrace, HugeFilesAreRefusedUnread) {
  fs::resize_file(folder_ + "/steps.csv", std::uintmax_t{1} << 33);
  EXPECT_NE(Error().find("/steps.csv: larger than"), std::string::npos) << Error();
  fs::resize_file(folder_ + "/config.yaml", std::uintmax_t{1} << 33);
  EXPECT_NE(Error().find("/config.yaml: larger than"), std::string::npos) << Error();
}

TEST_F(BadTrace, MissingKeyIsNamed) {
  Replace("velocity_gain: 1.0\n", "");
  ExpectError("/config.yaml:1", "'velocity_gain'");
}

TEST_F(BadTrace, MissingWeightIsNamedWithItsLine) {
  Replace("semantic: 0.09, ", "");
  ExpectError("/config.yaml:11", "'reward_weights.semantic'");
}

TEST_F(BadTrace, UnknownKeyIsNamedWithItsLine) {
  Replace("dt: 0.1\n", "dt: 0.1\ndt_s: 0.1\n");
  ExpectError("/config.yaml:4", "unknown key 'dt_s'");
}

TEST_F(BadTrace, WrongTypesAreNamedWithTheirLine) {
  const std::string good = config_;
  const auto check = [&](const std::string& from, const std::string& to, const std::string& place,
                         const std::string& what) {
    config_ = good;
    Replace(from, to);
    ExpectError(place, what);
  };
  check("dt: 0.1", "dt: fast", "/config.yaml:3", "'dt': expected a finite number");
  check("dt: 0.1", "dt: [0.1]", "/config.yaml:3", "'dt'");
  check("dt: 0.1", "dt: .nan", "/config.yaml:3", "'dt'");
  check("dt: 0.1", "dt: .inf", "/config.yaml:3", "'dt'");
  check("dt: 0.1", "dt: -0.1", "/config.yaml", "time.dt_s");
  check("agents: 4", "agents: 4.5", "/config.yaml:2", "'agents'");
  check("agents: 4", "agents: 0", "/config.yaml:2", "'agents'");
  check("agents: 4", "agents: 1.0e300", "/config.yaml:2", "'agents'");
  check("agents: 4", "agents: 3", "/config.yaml:13", "'initial_positions'");
  check("velocity3", "velocity4", "/config.yaml:4", "tau6, velocity3");
  check("reward: stg", "reward: {stg: 1}", "/config.yaml:10", "'reward'");
  check("target_velocity: [", "target_velocity: [0.0, ", "/config.yaml:18", "three numbers");
  check("target_position: [", "target_position: [x", "/config.yaml:17", "'target_position'");
  check("dt: 0.1", "dt: [0.1", "/config.yaml:", "");
}

TEST_F(BadTrace, BadCellsAreNamedWithLineAndColumn) {
  const auto good = lines_;
  for (const char* value : {"nan", "inf", "fast", "1.0x", "1e999"}) {
    lines_ = good;
    SetCell(7, "obs3", value);
    ExpectError("/steps.csv:7", "'obs3'");
  }
  lines_ = good;
  SetCell(6, "a1", "");
  ExpectError("/steps.csv:6", "'a1'");
}

TEST_F(BadTrace, ShortAndLongRowsAreNamedWithTheirLine) {
  const auto good = lines_;
  lines_[4] = lines_[4].substr(0, lines_[4].rfind(','));
  ExpectError("/steps.csv:5", "cells");
  lines_ = good;
  lines_[4] += ",0.0";
  ExpectError("/steps.csv:5", "cells");
}

TEST_F(BadTrace, AMissingRowIsRefused) {
  lines_.pop_back();
  ExpectError("/steps.csv:8", "whole number of steps of 4 rows");
}

TEST_F(BadTrace, AMissingActionColumnIsRefused) {
  SetCell(1, "a2", "thrust");
  ExpectError("/steps.csv:1", "a2");
}

TEST_F(BadTrace, ATraceWithNothingToCompareIsRefused) {
  for (const char* name : {"reward", "r_track", "r_obs", "r_coord", "r_comm", "r_sem", "cost"}) {
    SetCell(1, name, std::string("x_") + name);
  }
  ExpectError("/steps.csv:1", "reward");
}

}  // namespace
}  // namespace stg::env

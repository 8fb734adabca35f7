#include "stg_env/record/recorder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "stg_env/env/evaluation.hpp"
#include "stg_env/record/message.hpp"
#include "stg_env/record/scene.hpp"

namespace stg::env {
namespace {

struct Read {
  nlohmann::json header;
  std::map<std::string, std::string> columns;  ///< raw bytes, without their padding

  template <class T>
  T At(const std::string& name, std::size_t index) const {
    T value;
    std::memcpy(&value, columns.at(name).data() + index * sizeof(T), sizeof(T));
    return value;
  }
};

std::uint32_t LengthAt(const std::string& bytes, std::size_t at) {
  std::uint32_t length = 0;
  for (int k = 3; k >= 0; --k) {
    length = length << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(k)]);
  }
  return length;
}

/// Reads the file as docs/recording.md describes it, without code of the product.
std::vector<Read> ReadAll(const std::string& bytes) {
  static const std::map<std::string, std::size_t> kSizes = {
      {"f8", 8}, {"f4", 4}, {"i4", 4}, {"u1", 1}};
  std::vector<Read> all;
  EXPECT_EQ(bytes.substr(0, 8), kRecordingMagic);
  for (std::size_t at = 8; at < bytes.size();) {
    const std::size_t header = LengthAt(bytes, at), body = LengthAt(bytes, at + 4);
    Read& read = all.emplace_back();
    read.header = nlohmann::json::parse(bytes.substr(at + 8, header));
    std::size_t place = at + 8 + header;
    if (read.header.contains("columns")) {
      for (const auto& column : read.header["columns"]) {
        const std::size_t size = read.header["rows"].get<std::size_t>() *
                                 column[2].get<std::size_t>() *
                                 kSizes.at(column[1].get<std::string>());
        read.columns[column[0].get<std::string>()] = bytes.substr(place, size);
        place += (size + 7) / 8 * 8;
      }
    }
    EXPECT_EQ(place, at + 8 + header + body);
    at = place;
  }
  return all;
}

std::string FileText(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class RecorderTest : public testing::Test {
 protected:
  static Scenario Short(const std::string& name) {
    return LoadNamedScenario(STG_SCENARIO_FOLDER, name, "combined_stress",
                             {"time.episode_steps=60", "time.tail_steps=20"});
  }
  std::vector<Read> Record(const Scenario& s, int flown, int recorded) {
    nlohmann::json scene = SceneOf(s.judge(), s.channel);
    scene["condition"] = "combined_stress";
    RecordEpisodes(EnvFactory(s), scene, agent::MakeDecider("pursuit", s.model()), 3000, flown,
                   recorded, folder_);
    return ReadAll(FileText(folder_ + "/recording.stgv"));
  }

  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
};

TEST_F(RecorderTest, FliesWhatTheEvaluationFlies) {
  const Scenario s = Short("medium");
  EvaluationOptions options;
  options.episodes = 6;
  const auto metrics =
      Evaluate(EnvFactory(s), agent::MakeDecider("pursuit", s.model()), options, nullptr);
  std::size_t episode = 0;
  for (const Read& read : Record(s, 6, 6)) {
    if (read.header["kind"] != "summary") continue;
    for (const auto& [name, value] : metrics[episode].Items()) {
      EXPECT_EQ(read.header["metrics"][name].get<double>(), value) << name << " of " << episode;
    }
    ++episode;
  }
  EXPECT_EQ(episode, 6U);
}

TEST_F(RecorderTest, NamesScenarioConditionAndPolicy) {
  const Read first = Record(Short("medium"), 1, 1).front();
  EXPECT_EQ(first.header["meta"]["scenario"], "medium");
  EXPECT_EQ(first.header["meta"]["condition"], "combined_stress");
  EXPECT_EQ(first.header["meta"]["policy"], "pursuit");
}

TEST_F(RecorderTest, HasEveryPacketOfItsLogOnce) {
  std::map<int, int> recorded, logged;
  for (const Read& read : Record(Short("medium"), 2, 2)) {
    if (read.header["kind"] != "packets") continue;
    for (std::size_t k = 0; k < read.header["rows"].get<std::size_t>(); ++k) {
      ++recorded[read.At<std::uint8_t>("fate", k)];
    }
  }
  std::istringstream log(FileText(folder_ + "/packets.csv"));
  std::string line;
  std::getline(log, line);
  // The number of fields before the fate. No field holds a comma.
  const auto before = std::count(line.begin(), line.begin() + line.find(",fate"), ',') + 1;
  while (std::getline(log, line)) {
    std::istringstream fields(line);
    std::string fate;
    for (auto k = before; k >= 0; --k) std::getline(fields, fate, ',');
    int reason = 0;
    while (reason > 0 ? acoustics::ToString(static_cast<acoustics::DropReason>(reason)) != fate
                      : fate != "delivered") {
      ASSERT_LT(++reason, acoustics::kDropReasons) << fate;
    }
    ++logged[reason];
  }
  EXPECT_GT(logged[0], 50);
  EXPECT_GT(logged.size(), 1U);
  EXPECT_EQ(recorded, logged);
}

TEST_F(RecorderTest, StatesAreThoseOfTheEnvironment) {
  const Scenario s = Short("medium");
  VectorEnvOptions options;
  options.seed = 3000;
  VectorEnv env(s, options);
  EnvMemory memory = env.MakeMemory();
  env.Reset(memory.arrays());
  bool found = false;
  for (const Read& read : Record(s, 1, 1)) {
    if (read.header["kind"] != "steps") continue;
    found = true;
    EXPECT_EQ(read.header["rows"], 60);
    for (int i = 0; i < s.run.agents; ++i) {
      const Vec3<double> p = env.vehicle(0, i).p_WB;
      const auto k = static_cast<std::size_t>(3 * i);
      EXPECT_EQ(read.At<float>("position", k), static_cast<float>(p.x));
      EXPECT_EQ(read.At<float>("position", k + 1), static_cast<float>(p.y));
      EXPECT_EQ(read.At<float>("position", k + 2), static_cast<float>(p.z));
    }
    for (std::size_t k = 0; k < 60; ++k) {
      EXPECT_DOUBLE_EQ(read.At<double>("t", k), static_cast<double>(k) * s.run.decision_dt_s());
    }
  }
  EXPECT_TRUE(found);
}

TEST_F(RecorderTest, TruthModeAndOpenWaterAreRecordedToo) {
  for (const char* name : {"medium_release", "field"}) {
    const Scenario s = Short(name);
    const auto all = Record(s, 1, 1);
    ASSERT_FALSE(all.empty());
    EXPECT_EQ(all.front().header["kind"], "meta");
    EXPECT_EQ(all.front().header["meta"]["agents"], s.run.agents);
    EXPECT_EQ(all.front().header["meta"].contains("bottom"), s.world.sea.open);
  }
}

TEST_F(RecorderTest, RangesAreNearTheDistanceWhereOneIsMeasured) {
  int ranges = 0;
  const Scenario s = LoadNamedScenario(STG_SCENARIO_FOLDER, "field", "nominal",
                                       {"time.episode_steps=60", "time.tail_steps=20"});
  for (const Read& read : Record(s, 1, 1)) {
    if (read.header["kind"] != "steps") continue;
    for (std::size_t k = 0; k < 60 * 4; ++k) {
      EXPECT_EQ(read.At<std::uint8_t>("aground", k), 0) << k;  // the bottom is far below
      const float range = read.At<float>("range", k);
      EXPECT_EQ(std::isfinite(range), read.At<std::uint8_t>("detected", k) == 1) << k;
      if (!std::isfinite(range)) continue;
      ++ranges;
      const float distance = read.At<float>("distance", k);
      EXPECT_NEAR(range, distance, 6.0F * (1.0F + 0.01F * distance)) << k;
    }
  }
  EXPECT_GT(ranges, 10);
}

TEST_F(RecorderTest, FolderThatCannotBeMadeIsTheUsersError) {
  const Scenario s = Short("medium");
  EXPECT_THROW(
      RecordEpisodes(EnvFactory(s), SceneOf(s.judge(), s.channel),
                     agent::MakeDecider("pursuit", s.model()), 0, 1, 1, "/dev/null/folder"),
      UserError);
}

}  // namespace
}  // namespace stg::env

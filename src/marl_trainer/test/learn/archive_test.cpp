#include "marl_trainer/learn/checkpoint/archive.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "marl_trainer/learn/checkpoint/checkpoint.hpp"
#include "marl_trainer/learn/nn/adam.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {
namespace {

namespace fs = std::filesystem;

class ArchiveTest : public ::testing::Test {
 protected:
  void SetUp() override { path_ = (folder_ / "file").string(); }

  std::string Bytes() const {
    std::ifstream in(path_, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }

  /// Writes a payload with a header that is right for it.
  void Write(const std::string& payload, std::uint32_t version = 3) const {
    std::uint64_t checksum = 14695981039346656037ULL;
    for (const char c : payload) {
      checksum = (checksum ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
    }
    std::string bytes = "STGTRAIN";
    const std::uint32_t reserved = 0;
    const std::uint64_t size = payload.size();
    bytes.append(reinterpret_cast<const char*>(&version), 4);
    bytes.append(reinterpret_cast<const char*>(&reserved), 4);
    bytes.append(reinterpret_cast<const char*>(&size), 8);
    bytes.append(reinterpret_cast<const char*>(&checksum), 8);
    std::ofstream(path_, std::ios::binary) << bytes << payload;
  }

  /// The message with which the file is refused.
  std::string Refusal() const {
    try {
      ReadArchive(path_);
    } catch (const UserError& error) {
      EXPECT_EQ(std::string(error.what()).rfind(path_, 0), 0U) << error.what();
      return error.what();
    }
    ADD_FAILURE() << "accepted";
    return "";
  }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::string path_;
};

/// The bytes of one array in a file.
std::string Entry(char type, const std::string& name, std::uint64_t count,
                  const std::string& data) {
  std::string bytes(1, type);
  bytes += static_cast<char>(name.size());
  bytes += name;
  bytes.append(reinterpret_cast<const char*>(&count), 8);
  return bytes + data;
}

std::string Count(std::uint32_t arrays) {
  return std::string(reinterpret_cast<const char*>(&arrays), 4);
}

Archive Example() {
  Archive archive;
  archive.Put("floats", std::vector<float>{1.5F, -0.0F, 1e-45F});
  archive.Put("none", std::vector<float>());
  archive.Put("text", std::string("two\nlines\0and a zero", 20));
  archive.PutInteger("count", -7);
  archive.PutNumber("best", -1e300);
  Archive part;
  part.Put("doubles", std::vector<double>{3.0, 1e-320});
  archive.PutPart("part", part);
  return archive;
}

TEST_F(ArchiveTest, WhatIsReadIsWhatWasWritten) {
  WriteArchive(Example(), path_);
  const Archive read = ReadArchive(path_);
  EXPECT_TRUE(read == Example());
  Archive other = Example();
  other.PutInteger("more", 0);
  EXPECT_FALSE(read == other);
  EXPECT_TRUE(std::signbit(read.Floats("floats")[1]));
  EXPECT_EQ(read.Floats("floats")[2], 1e-45F);
  EXPECT_EQ(read.Text("text").size(), 20U);
  EXPECT_EQ(read.Integer("count"), -7);
  EXPECT_EQ(read.Number("best"), -1e300);
  EXPECT_EQ(read.Part("part").Doubles("doubles", 2)[0], 3.0);
  EXPECT_FALSE(read.Part("part").Has("best"));
  EXPECT_FALSE(fs::exists(path_ + ".tmp"));
}

TEST_F(ArchiveTest, TheFormatIsTheDocumentedOne) {
  Archive archive;
  archive.Put("a", std::vector<float>{2.0F});
  WriteArchive(archive, path_);
  const float two = 2.0F;
  const std::string written = Bytes();
  Write(Count(1) + Entry('f', "a", 1, std::string(reinterpret_cast<const char*>(&two), 4)));
  EXPECT_EQ(written, Bytes());
}

TEST_F(ArchiveTest, AnArrayOfAnotherNameTypeOrSizeIsNamed) {
  const Archive archive = Example();
  const auto message = [](const auto& read) {
    try {
      read();
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message([&] { archive.Floats("other"); }), "'other' is missing");
  EXPECT_EQ(message([&] { archive.Doubles("floats"); }), "'floats' has another type");
  EXPECT_EQ(message([&] { archive.Floats("floats", 4); }), "'floats' has another size");
  EXPECT_EQ(message([&] { archive.Number("count"); }), "'count' has another type");
}

TEST_F(ArchiveTest, ForeignTruncatedAndDamagedFilesAreRefused) {
  EXPECT_NE(Refusal().find("no such checkpoint"), std::string::npos);
  WriteArchive(Example(), path_);
  const std::string good = Bytes();
  const auto write = [this](const std::string& bytes) {
    std::ofstream(path_, std::ios::binary) << bytes;
  };
  write("");
  EXPECT_NE(Refusal().find("not a checkpoint"), std::string::npos);
  write("PK\x03\x04" + good);
  EXPECT_NE(Refusal().find("not a checkpoint"), std::string::npos);
  write(good.substr(0, good.size() - 1));
  EXPECT_NE(Refusal().find("truncated"), std::string::npos);
  for (std::size_t at = 32; at < good.size(); ++at) {
    std::string flipped = good;
    flipped[at] = static_cast<char>(flipped[at] ^ 64);
    write(flipped);
    EXPECT_NE(Refusal().find("checksum"), std::string::npos) << at;
  }
  Write("whatever", 1);
  EXPECT_NE(Refusal().find("version 1 (a libtorch archive), this trainer reads 3"),
            std::string::npos);
}

TEST_F(ArchiveTest, LyingSizesWithARightChecksumAreRefusedWithoutAllocating) {
  const std::uint64_t huge = std::numeric_limits<std::uint64_t>::max();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const struct {
    std::string payload;
    const char* reason;
  } cases[] = {
      {"", "past the end"},
      {Count(1), "past the end"},
      {Count(0xFFFFFFFFU), "too many arrays"},
      {Count(1) + Entry('f', "a", huge, ""), "past the end"},
      {Count(1) + Entry('d', "a", huge / 8 + 2, "12345678"), "past the end"},
      {Count(1) + Entry('t', "a", 9, "12345678"), "past the end"},
      {Count(1) + Entry('x', "a", 1, "12345678"), "unknown type"},
      {Count(1) + Entry('t', "", 1, "1"), "name"},
      {Count(2) + Entry('t', "a", 1, "1") + Entry('t', "a", 1, "1"), "name"},
      {Count(1) + Entry('t', "a", 1, "1") + "rest", "after the last array"},
      {Count(1) + Entry('f', "a", 1, std::string(reinterpret_cast<const char*>(&nan), 4)),
       "not finite"},
  };
  for (const auto& c : cases) {
    Write(c.payload);
    EXPECT_NE(Refusal().find(c.reason), std::string::npos) << c.reason;
  }
}

/// The message with which Load refuses the archive, or "accepted".
template <class Load>
std::string RefusalOf(const Load& load) {
  try {
    load();
  } catch (const UserError& error) {
    return error.what();
  }
  return "accepted";
}

TEST_F(ArchiveTest, CountsAreCounts) {
  Archive archive;
  archive.PutInteger("all", Archive::kMaxCount);
  archive.PutInteger("more", Archive::kMaxCount + 1);
  archive.PutInteger("less", -1);
  EXPECT_EQ(archive.Count("all"), 1LL << 53);
  EXPECT_EQ(RefusalOf([&] { archive.Count("more"); }),
            "'more' is 9007199254740993, which is not a count");
  EXPECT_EQ(RefusalOf([&] { archive.Count("less"); }), "'less' is -1, which is not a count");
}

TEST_F(ArchiveTest, ATrainingOfNegativeStepsIsRefused) {
  const auto refusal = [this](const auto& change) {
    TrainState state;
    change(&state);
    SaveCheckpoint(state, path_);
    return RefusalOf([this] { LoadCheckpoint(path_); });
  };
  EXPECT_EQ(refusal([](TrainState*) {}), "accepted");
  EXPECT_NE(refusal([](TrainState* s) {
              s->env_steps = -4000000000;
            }).find("'env_steps' is -4000000000, which is not a count"),
            std::string::npos);
  EXPECT_NE(refusal([](TrainState* s) { s->collections = -1; }).find("'collections'"),
            std::string::npos);
  EXPECT_NE(refusal([](TrainState* s) { s->round = 1ULL << 63; }).find("'round'"),
            std::string::npos);
  EXPECT_NE(refusal([](TrainState* s) { s->wall_seconds = -1.0; }).find("'wall_seconds'"),
            std::string::npos);
}

TEST_F(ArchiveTest, MomentsThatWouldBecomeNaNAreRefused) {
  Archive archive;
  archive.Put("a_first", std::vector<float>{1.0F});
  archive.Put("a_second", std::vector<float>{-1.0F});
  archive.PutInteger("a_steps", 1);
  AdamState state;
  state.first = state.second = {0.5F};
  EXPECT_NE(RefusalOf([&] { state.Load("a", archive); }).find("negative square"),
            std::string::npos);
  EXPECT_EQ(state.first[0], 0.5F);
  Archive steps;
  steps.Put("a_first", std::vector<float>{1.0F});
  steps.Put("a_second", std::vector<float>{1.0F});
  steps.PutInteger("a_steps", -1);
  EXPECT_NE(RefusalOf([&] { state.Load("a", steps); }).find("not a count"), std::string::npos);

  RunningMoments moments(1);
  EXPECT_EQ(RefusalOf([&] { moments.Load({2.0, -5.0, 1.0}); }), "accepted");
  EXPECT_NE(RefusalOf([&] { moments.Load({-1.0, 0.0, 1.0}); }).find("negative"), std::string::npos);
  EXPECT_NE(RefusalOf([&] { moments.Load({2.0, 0.0, -1.0}); }).find("negative"), std::string::npos);
  EXPECT_EQ(moments.mean(0), -5.0);
}

TEST_F(ArchiveTest, AFileThatCannotBeWrittenIsNamed) {
  path_ = (folder_ / "no such folder" / "file").string();
  try {
    WriteArchive(Example(), path_);
    FAIL();
  } catch (const UserError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(path_ + ": cannot write", 0), 0U) << error.what();
  }
}

}  // namespace
}  // namespace stg::learn

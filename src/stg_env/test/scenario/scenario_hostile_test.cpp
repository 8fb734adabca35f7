#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "scenario/scenario_input.hpp"
#include "stg_env/scenario/scenario.hpp"

/// Files that are no scenario at all. The loader refuses each of them quickly, and always with
/// UserError.
namespace stg {
namespace {

namespace fs = std::filesystem;

class HostileFile : public scenario_test::ScenarioFolder {
 protected:
  static void ExpectRefused(const std::string& file, const std::string& start_after_file,
                            const std::string& what) {
    try {
      LoadScenario(file);
      ADD_FAILURE() << file << " was loaded";
    } catch (const UserError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.rfind(file + start_after_file, 0), 0u) << message;
      EXPECT_NE(message.find(what), std::string::npos) << message;
    }
  }
  /// True if the file was loaded, false if it was refused. Any other exception fails the test.
  static bool LoadsOrRefuses(const std::string& file) {
    try {
      LoadScenario(file);
      return true;
    } catch (const UserError&) {
      return false;
    } catch (...) {
      ADD_FAILURE() << "neither loaded nor UserError";
      return false;
    }
  }
};

TEST_F(HostileFile, EmptyFileIsRefused) {
  ExpectRefused(Write("a.yaml", ""), ":1: ", "the file is empty");
  ExpectRefused(Write("b.yaml", "# only a comment\n"), ":1: ", "the file is empty");
  ExpectRefused(Write("c.yaml", "---\n...\n"), ":1: ", "the file is empty");
}

TEST_F(HostileFile, AByteOrderMarkIsHarmless) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_TRUE(LoadsOrRefuses(Write("a.yaml", mark + ToYaml(Scenario{}))));
  ExpectRefused(Write("b.yaml", mark + "agents: 0\n"), ":1: ", "agents");
}

TEST_F(HostileFile, ThingsThatAreNoRegularFileAreRefused) {
  ExpectRefused((folder_ / "none.yaml").string(), ": ", "no such file");
  ExpectRefused(folder_.string(), ": ", "is a directory");
  const std::string pipe = (folder_ / "pipe.yaml").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  ExpectRefused(pipe, ": ", "not a regular file");
  ExpectRefused("/dev/zero", ": ", "not a regular file");
  const std::string loop = (folder_ / "loop.yaml").string();
  ASSERT_EQ(symlink(loop.c_str(), loop.c_str()), 0);
  ExpectRefused(loop, ": ", "symbolic links");
}

TEST_F(HostileFile, UnreadableFileIsRefused) {
  const std::string file = Write("secret.yaml", ToYaml(Scenario{}));
  ASSERT_EQ(chmod(file.c_str(), 0), 0);
  ASSERT_EQ(chmod(folder_.c_str(), 0755), 0);
  // Root can read every file, so the test becomes another user for a moment.
  const bool root = geteuid() == 0;
  ASSERT_EQ(root ? seteuid(65534) : 0, 0);
  ExpectRefused(file, ": ", "cannot be read: Permission denied");
  ASSERT_EQ(root ? seteuid(0) : 0, 0);
}

TEST_F(HostileFile, HugeFileIsRefusedBeforeReading) {
  const std::string file = Write("huge.yaml", "name: a\n");
  fs::resize_file(file, std::uintmax_t{1} << 40);  // sparse
  ExpectRefused(file, ": ", "larger than 1048576 bytes");
  fs::resize_file(file, (1 << 20) + 1);
  ExpectRefused(file, ": ", "larger than 1048576 bytes");
}

TEST_F(HostileFile, SyntaxErrorsNameTheLine) {
  ExpectRefused(Write("a.yaml", "name: a\nagents: 4: 5\n"), ":2: ", "not valid YAML");
  ExpectRefused(Write("b.yaml", "name: a\n\ttime:\n"), ":2: ", "not valid YAML");
  ExpectRefused(Write("c.yaml", "name: [a\n"), ":", "not valid YAML");
  ExpectRefused(Write("d.yaml", "- a\n- b\n"), ":1: ", "expected a map of keys, found a sequence");
  ExpectRefused(Write("e.yaml", "hello\n"), ":1: ", "expected a map of keys, found 'hello'");
  ExpectRefused(Write("f.yaml", "? [a, b]\n: 1\n"), ":1: ", "a key must be a plain word");
  ExpectRefused(Write("g.yaml", std::string("name: a\0b\n", 10)), ":1: ", "not a text file");
  ExpectRefused(Write("h.yaml", ToYaml(Scenario{}) + "---\nname: b\n"), ":", "more than one");
  ExpectRefused(Write("i.yaml", "name: !!binary aGk=\n"), ":1: ", "tags are not allowed");
}

TEST_F(HostileFile, AliasesAreRefusedSoThatNoneCanMultiply) {
  std::string bomb = "a: &a [x, x, x, x, x, x, x, x, x, x]\n";
  for (char c = 'b'; c <= 'i'; ++c) {
    const std::string last = std::string("*") + static_cast<char>(c - 1);
    bomb += std::string(1, c) + ": &" + c + " [" + last;
    for (int i = 0; i < 9; ++i) bomb += ", " + last;
    bomb += "]\n";
  }
  ExpectRefused(Write("bomb.yaml", bomb), ":1: ", "anchors (&name) are not allowed");
  ExpectRefused(Write("merge.yaml", "name: a\n<<: {agents: 3}\n"), ":2: <<: ", "unknown key");
}

TEST_F(HostileFile, DeepAndWideFilesAreRefused) {
  for (const char* piece : {"[", "{", "{a: ", "[a,", "? ", "- ", "a:\n", "\"", "'", "*a ", "&a "}) {
    std::string text;
    while (text.size() < 200000) text += piece;
    EXPECT_FALSE(LoadsOrRefuses(Write("deep.yaml", text))) << piece;
    EXPECT_FALSE(LoadsOrRefuses(Write("wide.yaml", "agents: [" + text))) << piece;
  }
}

TEST_F(HostileFile, BaseThatLeadsBackToItselfIsRefused) {
  ExpectRefused(Write("self.yaml", "name: a\nbase: self.yaml\n"),
                ":2: base: ", "is based on this file");
  Write("x.yaml", "base: y.yaml\n");
  const std::string y = Write("y.yaml", "\nbase: ./x.yaml\n");
  try {
    LoadScenario((folder_ / "x.yaml").string());
    ADD_FAILURE();
  } catch (const UserError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("y.yaml:2: base: './x.yaml' is based on this file"), std::string::npos)
        << message;
  }
}

TEST_F(HostileFile, BaseThatIsNoFileIsRefusedWhereItIsNamed) {
  ExpectRefused(Write("a.yaml", "base: none.yaml\n"), ":1: base: ", "is not a file");
  EXPECT_EQ(LoadScenario(Write("mine.yaml", "base: medium.yaml\nagents: 3\n")).run.agents, 3);
  ExpectRefused(Write("b.yaml", "base: .\n"), ":1: base: ", "is not a file");
  ExpectRefused(Write("c.yaml", "base: [a]\n"), ":1: base: ", "expected a file name");
  ExpectRefused(Write("d.yaml", "base:\n"), ":1: base: ", "expected a file name");
  std::string last = "end.yaml";
  Write(last, ToYaml(Scenario{}));
  for (int i = 0; i < 12; ++i) {
    const std::string name = "chain" + std::to_string(i) + ".yaml";
    Write(name, "base: " + last + "\n");
    last = name;
  }
  EXPECT_FALSE(LoadsOrRefuses((folder_ / last).string()));
  EXPECT_TRUE(LoadsOrRefuses((folder_ / "chain5.yaml").string()));
}

TEST_F(HostileFile, OverlayMayNotNameABase) {
  const std::string base = Write("base.yaml", ToYaml(Scenario{}));
  const std::string overlay = Write("overlay.yaml", "agents: 3\nbase: base.yaml\n");
  try {
    LoadScenario(base, {overlay});
    ADD_FAILURE();
  } catch (const UserError& error) {
    EXPECT_EQ(std::string(error.what()), overlay + ":2: base: an overlay has no base");
  }
}

TEST_F(HostileFile, TruncatedFileIsLoadedOrRefused) {
  const std::string text = ToYaml(Scenario{});
  for (std::size_t length = 0; length < text.size() - 20; length += 50) {
    EXPECT_FALSE(LoadsOrRefuses(Write("cut.yaml", text.substr(0, length)))) << length;
  }
  EXPECT_TRUE(LoadsOrRefuses(Write("whole.yaml", text)));
}

TEST_F(HostileFile, DamagedFileIsLoadedOrRefused) {
  const std::string text = ToYaml(Scenario{});
  const std::string bytes = "[]{}:,-?&*!|>'\"%@#~\n\t \\.e0\xff\xc3\x01";
  int refused = 0;
  for (std::uint32_t trial = 0; trial < 400; ++trial) {
    Random random(7, Stream::kReset, trial, 0, 0);
    std::string damaged = text;
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<std::size_t>(random.Uniform() * static_cast<double>(text.size()));
      damaged[at] = bytes[random.Bits() % bytes.size()];
    }
    refused += LoadsOrRefuses(Write("damaged.yaml", damaged)) ? 0 : 1;
  }
  EXPECT_GT(refused, 200);
}

}  // namespace
}  // namespace stg

#include <fcntl.h>
#include <signal.h>
#include <sys/ioctl.h>

#include <chrono>
#include <functional>
#include <thread>

#include "simulate_fixture.hpp"

/// The program is stopped before its end. The tests check what is in the folder then.
namespace stg::acoustics {
namespace {

class SimulateEnds : public Simulate {
 protected:
  void SetUp() override {
    Simulate::SetUp();
    out_ = folder_ + "/out";
    small_ = Write(Network(20.0, "{source: 0, kind: at, times_s: [1.0], bytes: 32}"), "small.yaml");
    // It runs longer than any machine takes until the signal, which follows the first packets.
    endless_ = Write(Network(9e7, "{source: 0, kind: periodic, period_s: 1000.0, bytes: 32}"),
                     "long.yaml");
  }
  void TearDown() override {
    if (child_ > 0) ::kill(child_, SIGKILL);
    Simulate::TearDown();
  }

  static std::string Network(double duration_s, const std::string& flow) {
    return "duration_s: " + std::to_string(duration_s) +
           "\nseed: 1\nchannel:\n  model: physical\n  access: aloha\n"
           "  physical:\n    modem: {profile: evologics_s2c}\n" +
           kSteadyWater + "nodes:\n" + NodeAt(0, 0, 0) + NodeAt(1, 90, 0) + "traffic:\n  - " +
           flow + "\n";
  }

  /// Starts the endless simulation, with its output in a file. Waits for its first rows.
  void Start(const std::function<void()>& prepare = [] {}) {
    const std::string text = folder_ + "/text", rows = out_ + "/packets.csv.tmp";
    child_ = ::fork();
    ASSERT_GE(child_, 0);
    if (child_ == 0) {
      ::dup2(::open(text.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 1);
      ::signal(SIGHUP, SIG_DFL);  // somebody may run the tests under nohup
      prepare();
      ::execl(STG_SIMULATE, STG_SIMULATE, endless_.c_str(), "--out", out_.c_str(), "--quiet",
              static_cast<char*>(nullptr));
      ::_exit(99);
    }
    while (!std::filesystem::exists(rows) || std::filesystem::file_size(rows) == 0) {
      ASSERT_EQ(::waitpid(child_, nullptr, WNOHANG), 0) << "it ended by itself";
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  /// Expects that the program has ended as a stopped one, and that its folder holds what it had.
  void ExpectStopped() {
    int status = 0;
    ASSERT_EQ(::waitpid(child_, &status, 0), child_);
    child_ = -1;
    ASSERT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 130);
    const auto json = nlohmann::json::parse(Read(out_ + "/summary.json"), nullptr, false);
    ASSERT_TRUE(json.is_object());
    EXPECT_EQ(json["finished"], false);
    EXPECT_GT(json["delivered"], 0);
    EXPECT_LT(json["duration_s"], 9e7);
    EXPECT_NE(Read(out_ + "/packets.csv").find("\n0,1,"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(out_ + "/packets.csv.tmp"));
    EXPECT_EQ(Read(out_ + "/simulation.yaml"), Read(endless_));
  }

  std::string out_, small_, endless_;
  pid_t child_ = -1;
};

TEST_F(SimulateEnds, WhateverStopsItItKeepsWhatItHas) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Start();
    ASSERT_FALSE(HasFatalFailure());
    ::kill(child_, signal);
    ExpectStopped();
    const auto sent = nlohmann::json::parse(Read(folder_ + "/text"), nullptr, false);
    EXPECT_EQ(sent["finished"], false) << signal;
  }
}

TEST_F(SimulateEnds, AClosedTerminalStopsItToo) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_TRUE(terminal >= 0 && ::grantpt(terminal) == 0 && ::unlockpt(terminal) == 0);
  const std::string name = ::ptsname(terminal);
  Start([&] {
    ::setsid();
    const int ours = ::open(name.c_str(), O_RDWR);
    ::ioctl(ours, TIOCSCTTY, 0);
    for (const int stream : {0, 1, 2}) ::dup2(ours, stream);
  });
  ASSERT_FALSE(HasFatalFailure());
  ::close(terminal);
  ExpectStopped();
}

TEST_F(SimulateEnds, AHangupThatNohupIgnoresIsIgnored) {
  Start([] { ::signal(SIGHUP, SIG_IGN); });
  ASSERT_FALSE(HasFatalFailure());
  const std::string status = Read("/proc/" + std::to_string(child_) + "/status");
  const auto ignored = std::stoull(status.substr(status.find("SigIgn:") + 7), nullptr, 16);
  EXPECT_TRUE((ignored >> (SIGHUP - 1)) & 1U);
  ::kill(child_, SIGTERM);
  ExpectStopped();
}

TEST_F(SimulateEnds, ARunHasItsFolderForItself) {
  Start();
  ASSERT_FALSE(HasFatalFailure());
  const Result second = Command("'" + small_ + "' --out '" + out_ + "'");
  EXPECT_EQ(second.code, 2);
  EXPECT_EQ(second.err, "simulate: " + out_ + ": another program is writing into it\n");
  ::kill(child_, SIGINT);
  ExpectStopped();
}

TEST_F(SimulateEnds, AFullDiskLeavesTheResultsOfBefore) {
  const std::string arguments = "'" + small_ + "' --out '" + out_ + "' --quiet";
  ASSERT_EQ(Command(arguments).code, 0);
  std::vector<std::string> before;
  const std::vector<std::string> files = {"/packets.csv", "/summary.json", "/simulation.yaml"};
  for (const std::string& file : files) before.push_back(Read(out_ + file));
  Write(Network(40.0, "{source: 1, kind: at, times_s: [1.0], bytes: 32}"), "small.yaml");
  std::filesystem::create_symlink("/dev/full", out_ + "/packets.csv.tmp");
  const Result full = Command(arguments);
  EXPECT_EQ(full.code, 2);
  EXPECT_EQ(full.err, "simulate: " + out_ +
                          "/packets.csv: cannot write the packets: rows are lost, is the disk "
                          "full?\n");
  for (std::size_t i = 0; i < files.size(); ++i) {
    EXPECT_EQ(Read(out_ + files[i]), before[i]) << files[i];
  }
}

TEST_F(SimulateEnds, StandardOutputThatIsLostIsTold) {
  const std::string err = folder_ + "/err";
  const int status = std::system(
      ("'" STG_SIMULATE "' '" + small_ + "' --out '" + out_ + "' > /dev/full 2> '" + err + "'")
          .c_str());
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 2) << status;
  EXPECT_EQ(Read(err), "simulate: standard output cannot be written\n");
  EXPECT_EQ(nlohmann::json::parse(Read(out_ + "/summary.json"), nullptr, false)["finished"], true);
}

}  // namespace
}  // namespace stg::acoustics

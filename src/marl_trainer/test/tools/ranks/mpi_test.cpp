#include <sys/wait.h>

#include <cstdlib>

#include "learn/trainer_fixture.hpp"

/// Runs the program among several processes, as a user starts it.
namespace stg::learn {
namespace {

// Open MPI leaks memory in plug-ins. They are unloaded at the end, so the leak sanitizer cannot
// suppress them by name.
const std::string kMpirun =
    "ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 OMPI_ALLOW_RUN_AS_ROOT=1 "
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 STG_SCENARIOS=" STG_SCENARIO_FOLDER " " STG_MPIRUN
    " --oversubscribe --bind-to none -n ";

class MpiTest : public TrainerTest {
 protected:
  std::string Command(int ranks, const std::string& name, const std::string& more) const {
    return kMpirun + std::to_string(ranks) +
           " " STG_TRAIN
           " --scenario medium_release --envs 32 --horizon 20 --minibatch 160 "
           "--validation-episodes 20"
           " --actor-hidden 16 --critic-hidden 16 --validation-interval 100000 --out " +
           (folder_ / name).string() + " " + more;
  }
  /// Runs the command. Returns its exit status.
  int Run(const std::string& command) const {
    const std::string log = (folder_ / "log").string();
    const int status = std::system(("( " + command + " ) > " + log + " 2>&1").c_str());
    output_ = Bytes(log);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string Policy(const std::string& name) const {
    return Bytes(folder_ / name / "policy_last.onnx");
  }
  mutable std::string output_;
};

TEST_F(MpiTest, OneAndTwoRanksAndTwoWorkersGiveTheSamePolicy) {
  ASSERT_EQ(Run(Command(1, "one", "--steps 2560 --workers 1")), 0) << output_;
  ASSERT_EQ(Run(Command(2, "two", "--steps 2560 --workers 1")), 0) << output_;
  ASSERT_EQ(Run(Command(1, "workers", "--steps 2560 --workers 2")), 0) << output_;
  EXPECT_FALSE(Policy("one").empty());
  EXPECT_EQ(Policy("two"), Policy("one"));
  EXPECT_EQ(Policy("workers"), Policy("one"));
}

TEST_F(MpiTest, ALostRankEndsTheRunAndResumeGoesOn) {
  const std::string options = "--checkpoint-interval 1280 --workers 1 ";
  ASSERT_EQ(Run(Command(2, "whole", options + "--steps 32000")), 0) << output_;
  // One process is killed as soon as there is a checkpoint.
  const std::string checkpoints = (folder_ / "lost" / "checkpoint_*").string();
  const std::string lose = " & run=$!; until ls " + checkpoints +
                           "; do kill -0 $run || exit 9; sleep 0.02; done;"
                           " kill -9 $(pgrep -P $run train | head -1); wait $run";
  EXPECT_NE(Run(Command(2, "lost", options + "--steps 32000") + lose), 0) << output_;
  EXPECT_NE(Policy("lost"), Policy("whole"));
  ASSERT_EQ(Run(Command(2, "lost", options + "--steps 32000 --resume")), 0) << output_;
  EXPECT_EQ(Policy("lost"), Policy("whole"));
}

TEST_F(MpiTest, WhatCannotBeSharedIsToldOnce) {
  EXPECT_EQ(Run(Command(3, "three", "")), 2);
  const std::string reason = "train: started with 3 ranks: their number must be a power of two";
  const std::size_t found = output_.find(reason);
  ASSERT_NE(found, std::string::npos) << output_;
  EXPECT_EQ(output_.find(reason, found + 1), std::string::npos);
}

}  // namespace
}  // namespace stg::learn

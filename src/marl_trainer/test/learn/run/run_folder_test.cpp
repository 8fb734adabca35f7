#include "marl_trainer/learn/run/run_folder.hpp"

#include <sys/resource.h>

#include <csignal>

#include "auv_common/error.hpp"
#include "learn/trainer_fixture.hpp"

/// What a training does when the disk is full.
namespace stg::learn {
namespace {

/// No file of this process can grow beyond a number of bytes. Writes fail as on a full disk.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

template <class Work>
std::string Refusal(const Work& work) {
  try {
    work();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

using RunFolderTest = TrainerTest;

TEST_F(RunFolderTest, AFileThatADiskIsTooFullForIsNamedAndTheOldOneKept) {
  TrainSetup setup = SmallSetup();
  setup.common.steps = 640;
  Trainer::Options options = Options("run");
  options.mix = {ShortScenario()};
  const auto run = [&] { Trainer(ShortScenario(), setup, options).Run(); };
  run();
  options.resume = true;
  for (const char* name :
       {"config.json", "scenario.yaml", "train_on_0.yaml", "progress.csv", "summary.json"}) {
    const fs::path file = folder_ / "run" / name;
    const std::string before = Bytes(file);
    ASSERT_FALSE(before.empty()) << name;
    fs::create_symlink("/dev/full", file.string() + ".tmp");
    const std::string refusal = Refusal(run);
    EXPECT_EQ(refusal.rfind(file.string() + ": cannot write ", 0), 0U) << name << ": " << refusal;
    EXPECT_NE(refusal.find("No space left on device"), std::string::npos) << refusal;
    EXPECT_EQ(Bytes(file), before) << name;
    EXPECT_FALSE(fs::is_symlink(file.string() + ".tmp")) << name;
  }
  EXPECT_EQ(Refusal(run), "");
}

TEST_F(RunFolderTest, ADiskThatGetsFullUnderTheProgressEndsTheTraining) {
  fs::create_directory(folder_ / "run");
  const std::string folder = (folder_ / "run").string();
  TrainLog log(folder, {}, -1, 1000, &log_);
  const FileLimit limit(fs::file_size(folder + "/progress.csv") + 1000);
  TrainRecord record;
  const std::string refusal = Refusal([&] {
    for (record.env_steps = 1; record.env_steps <= 100; ++record.env_steps) {
      log.Add(record);
      log.Flush();
    }
  });
  EXPECT_EQ(refusal, folder + "/progress.csv: cannot write the progress");
  EXPECT_GT(record.env_steps, 1);
}

}  // namespace
}  // namespace stg::learn

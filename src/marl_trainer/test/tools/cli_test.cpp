#include <cmath>
#include <utility>
#include <vector>

#include "cli_fixture.hpp"

namespace stg::env {
namespace {

struct Program {
  const char *path, *arguments;
};
const Program kPrograms[] = {{STG_EVALUATE, "--policy idle --episodes 1"},
                             {STG_BENCH_ENV, "--seconds 0.05"},
                             {STG_CHECK_TRACE, STG_TEST_DATA "/golden/velocity_medium"}};

TEST_F(CommandLine, HelpNamesTheOptionsAndSucceeds) {
  const std::vector<std::vector<const char*>> options = {
      {"--policy", "--scenario", "--condition", "--episodes", "--seed", "--gain", "--standoff",
       "--cap", "--csv"},
      {"--scenario", "--seconds", "--workers"},
      {"--tolerance"}};
  for (size_t p = 0; p < 3; ++p) {
    const Result r = Run(kPrograms[p].path, "--help");
    EXPECT_EQ(r.code, 0);
    for (const char* option : options[p])
      EXPECT_NE(r.out.find(option), std::string::npos) << option;
  }
}

TEST_F(CommandLine, UnknownOptionsFailAndAreNamed) {
  for (const Program& p : kPrograms) {
    const Result r = Run(p.path, std::string(p.arguments) + " --no-such-option");
    EXPECT_NE(r.code, 0) << p.path;
    EXPECT_NE(r.err.find("--no-such-option"), std::string::npos) << r.err;
    EXPECT_EQ(r.out.find('{'), std::string::npos);
  }
}

TEST_F(CommandLine, ABadScenarioExitsWithTwoAndNamesFileLineAndKey) {
  for (const Program& p : kPrograms) {
    Result r = Run(p.path, std::string(p.arguments) + " --scenario " + Scenario("agents: 0\n"));
    EXPECT_EQ(r.code, 2) << p.path;
    EXPECT_NE(r.err.find("bad.yaml:2"), std::string::npos) << r.err;
    EXPECT_NE(r.err.find("agents"), std::string::npos) << r.err;
    EXPECT_EQ(r.out.find('{'), std::string::npos);
    r = Run(p.path,
            std::string(p.arguments) + " --scenario " + Scenario("sensing:\n  rnage_m: 0.3\n"));
    EXPECT_EQ(r.code, 2) << p.path;
    EXPECT_NE(r.err.find("bad.yaml:3"), std::string::npos) << r.err;
    EXPECT_NE(r.err.find("rnage_m"), std::string::npos) << r.err;
    r = Run(p.path, std::string(p.arguments) + " --scenario no_such_scenario");
    EXPECT_EQ(r.code, 2) << p.path;
    EXPECT_NE(r.err.find("no_such_scenario"), std::string::npos) << r.err;
  }
}

TEST_F(CommandLine, EvaluateRefusesBadValues) {
  for (const char* bad : {"--episodes 0", "--episodes many", "--condition no_such", "--cap 2",
                          "--gain -1", "--set agents=x", "--set no.such=1", "--policy /dev/null",
                          "--workers 0", "--csv /no/such/folder/x.csv"}) {
    std::string arguments = bad;
    if (arguments.find("--policy") == std::string::npos) arguments += " --policy idle";
    if (arguments.find("--episodes") == std::string::npos) arguments += " --episodes 1";
    const Result r = Run(STG_EVALUATE, arguments);
    EXPECT_NE(r.code, 0) << bad;
    EXPECT_FALSE(r.err.empty()) << bad;
  }
  EXPECT_NE(Run(STG_EVALUATE, "").code, 0);
}

TEST_F(CommandLine, EvaluateEndsWithTheMetricsOfTheContract) {
  const std::string csv = folder_ + "/episodes.csv";
  const Result r = Run(STG_EVALUATE,
                       "--policy pursuit --scenario medium_release --episodes 5 --seed 3000 "
                       "--set time.episode_steps=120 --csv " +
                           csv);
  ASSERT_EQ(r.code, 0) << r.err;
  const nlohmann::json json = r.Json();
  ASSERT_TRUE(json.is_object()) << r.out;
  for (const char* key : {"return", "tail_distance", "tracking_error", "lost_rate", "action_norm",
                          "saturation_rate", "control_cost", "communication_quality",
                          "colliding_pairs", "min_separation", "time_to_band"}) {
    ASSERT_TRUE(json.contains(key)) << key;
    ASSERT_TRUE(json.contains(std::string(key) + "_std")) << key;
    EXPECT_TRUE(std::isfinite(json[key].get<double>())) << key;
    EXPECT_GE(json[std::string(key) + "_std"].get<double>(), 0.0) << key;
  }
  EXPECT_EQ(json["episodes"], 5);
  EXPECT_EQ(json["seed"], 3000);
  EXPECT_GT(json["return_std"], 0.0);
  // The table has one row per episode. Its mean is the one in the JSON.
  std::ifstream in(csv);
  std::string line;
  ASSERT_TRUE(std::getline(in, line));
  EXPECT_EQ(line.rfind("episode,seed,return,", 0), 0u) << line;
  double sum = 0.0;
  int rows = 0;
  for (; std::getline(in, line); ++rows) {
    int episode = 0, seed = 0;
    double value = 0.0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%d,%d,%lf", &episode, &seed, &value), 3);
    EXPECT_EQ(episode, rows);
    EXPECT_EQ(seed, 3000 + rows);
    sum += value;
  }
  ASSERT_EQ(rows, 5);
  EXPECT_NEAR(sum / 5.0, json["return"].get<double>(), 0.01);
}

TEST_F(CommandLine, ProgramsFailWhereTheirOutputCannotBeWritten) {
  for (const Program& program : kPrograms) {
    const std::string command = std::string("'") + program.path + "' " + program.arguments +
                                " > /dev/full 2> '" + folder_ + "/stderr'";
    const int status = std::system(command.c_str());
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 2) << program.path << status;
    EXPECT_NE(Read(folder_ + "/stderr").find(": standard output cannot be written"),
              std::string::npos);
  }
}

TEST_F(CommandLine, ProgramsEndWithTheirResultWhereANameIsNoUtf8) {
  const std::string file = Scenario("seed: 1\n"), latin = folder_ + "/\xe9";
  fs::rename(file, latin + ".yaml");
  fs::create_directory_symlink(STG_TEST_DATA "/golden/velocity_medium", latin);
  for (const auto& [program, arguments] :
       {std::pair(STG_EVALUATE, "--policy idle --episodes 1 --scenario " + latin + ".yaml"),
        std::pair(STG_BENCH_ENV, "--seconds 0.05 --scenario " + latin + ".yaml"),
        std::pair(STG_CHECK_TRACE, latin)}) {
    const Result r = Run(program, arguments);
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_TRUE(r.Json().is_object()) << r.out;
  }
}

TEST_F(CommandLine, NumbersThatAreNoneAreRefused) {
  for (const char* seconds : {"nan", "0", "-1", "inf"}) {
    EXPECT_EQ(Run(STG_BENCH_ENV, std::string("--seconds ") + seconds).code, 2) << seconds;
  }
  EXPECT_EQ(Run(STG_CHECK_TRACE, STG_TEST_DATA "/golden/velocity_medium --tolerance nan").code, 2);
}

TEST_F(CommandLine, EvaluateKeepsTheOldTableWhereTheNewOneCannotBeWritten) {
  const std::string csv = folder_ + "/episodes.csv", start = "evaluate: " + folder_;
  const auto evaluate = [&](const std::string& file) {
    return Run(STG_EVALUATE,
               "--policy idle --episodes 1 --set time.episode_steps=120 --csv '" + file + "'");
  };
  std::ofstream(csv) << "old";
  fs::create_symlink("/dev/full", csv + ".tmp");
  Result r = evaluate(csv);
  EXPECT_EQ(r.code, 2);
  EXPECT_NE(r.err.find("\n" + start + "/episodes.csv: cannot write the table: No space left"),
            std::string::npos)
      << r.err;
  EXPECT_EQ(Read(csv), "old");
  EXPECT_EQ(evaluate(csv).code, 0);
  EXPECT_EQ(Read(csv).rfind("episode,seed,return,", 0), 0U);
  // The error comes before the first episode is flown.
  r = evaluate(folder_ + "/none/x.csv");
  EXPECT_EQ(r.code, 2);
  EXPECT_EQ(r.err, start + "/none/x.csv: cannot write the table: No such file or directory\n");
  EXPECT_EQ(evaluate(folder_).err, start + ": cannot write the table: is a directory\n");
}

TEST_F(CommandLine, EvaluateWritesItsTableIntoPipesAndDevicesAndReplacesNone) {
  const std::string arguments = "--policy idle --episodes 1 --set time.episode_steps=120 --csv ";
  const Result piped = Run(STG_EVALUATE, arguments + "/dev/stdout | cat");
  EXPECT_EQ(piped.out.rfind("episode,seed,return,", 0), 0U) << piped.err;
  EXPECT_TRUE(piped.Json().is_object()) << piped.out;
  // Run sends the standard output into a file, which --csv would replace.
  EXPECT_EQ(Run(STG_EVALUATE, arguments + "/dev/stdout").err,
            "evaluate: /dev/stdout: cannot write the table: standard output goes there\n");
  const std::string full = folder_ + "/full";
  fs::create_symlink("/dev/full", full);
  EXPECT_EQ(Run(STG_EVALUATE, arguments + "'" + full + "'").code, 2);
  EXPECT_TRUE(fs::is_symlink(full));
}

TEST_F(CommandLine, EvaluateTakesTheConstantsOfPursuit) {
  const std::string base =
      "--policy pursuit --scenario medium_release --episodes 4 --set time.episode_steps=150 ";
  const Result standard = Run(STG_EVALUATE, base);
  const Result simple = Run(STG_EVALUATE, base + "--gain 4.66 --standoff 0.009 --cap 0.75");
  const Result other = Run(STG_EVALUATE, base + "--standoff 0.05");
  nlohmann::json same = simple.Json();
  EXPECT_EQ(same["policy"], "pursuit:cap=0.75,gain=4.66,standoff=0.009");
  EXPECT_EQ(simple.out.rfind("pursuit:cap=0.75,gain=4.66,standoff=0.009 on ", 0), 0U);
  same["policy"] = "pursuit";
  EXPECT_EQ(standard.Json(), same);
  EXPECT_GT(other.Json()["tail_distance"], standard.Json()["tail_distance"]);
}

TEST_F(CommandLine, MotionOutOfHandNamesTheVehicleAndFails) {
  const std::string unstable = Scenario(
      "vehicle:\n  clip_velocity: false\n  fully_actuated:\n"
      "    linear_damping: [1e6, 1e6, 1e6, 1e6, 1e6, 1e6]\n");
  for (const char* what : {"pursuit", "pursuit --set mode=acoustic"}) {
    const Result r = Run(STG_EVALUATE, "--episodes 2 --scenario " + unstable + " --policy " + what);
    EXPECT_EQ(r.code, 2) << r.out;
    EXPECT_NE(r.err.find("state of AUV "), std::string::npos) << r.err;
    EXPECT_EQ(r.out.find("nan"), std::string::npos) << r.out;
  }
  const Result r = Run(STG_BENCH_ENV, "--workers 2 --seconds 0.1 --scenario " + unstable);
  EXPECT_EQ(r.code, 2) << "a worker's UserError ends the program as any other";
  EXPECT_NE(r.err.find("state of AUV "), std::string::npos) << r.err;
}

TEST_F(CommandLine, BenchEnvEndsWithItsRate) {
  const Result r = Run(STG_BENCH_ENV, "--scenario medium_release --seconds 0.1 --envs 8");
  ASSERT_EQ(r.code, 0) << r.err;
  const nlohmann::json json = r.Json();
  ASSERT_TRUE(json.is_object()) << r.out;
  const double rate = json["env_steps_per_second"];
  EXPECT_TRUE(std::isfinite(rate) && rate > 0.0) << rate;  // the benchmarks check how fast it is
}

TEST_F(CommandLine, CheckTraceSucceedsWithinAndFailsPastTheTolerance) {
  Result r = Run(STG_CHECK_TRACE,
                 STG_TEST_DATA "/golden/velocity_medium " STG_TEST_DATA "/golden/force_medium");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  EXPECT_LE(r.Json()["max_abs_error"], 1e-5);
  EXPECT_EQ(r.Json()["traces"].size(), 2u);
  // One number of one row is changed.
  const std::string bad = folder_ + "/trace";
  fs::create_directory(bad);
  fs::copy_file(STG_TEST_DATA "/golden/velocity_medium/config.yaml", bad + "/config.yaml");
  std::ifstream in(STG_TEST_DATA "/golden/velocity_medium/steps.csv");
  std::ofstream out(bad + "/steps.csv");
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    // A row ends with the distance and the flag `lost`.
    if (number == 100) line.back() = line[line.size() - 1] == '1' ? '0' : '1';
    out << line << '\n';
  }
  out.close();
  r = Run(STG_CHECK_TRACE, bad);
  EXPECT_EQ(r.code, 1) << r.out << r.err;
  EXPECT_GT(r.Json()["max_abs_error"], 1e-5);
  EXPECT_EQ(r.Json()["pass"], false);
  r = Run(STG_CHECK_TRACE, STG_TEST_DATA "/golden/velocity_medium --tolerance 1e-15");
  EXPECT_EQ(r.code, 1);
}

TEST_F(CommandLine, CheckTraceExitsWithTwoForWhatIsNoTrace) {
  for (const std::string& what : {folder_, folder_ + "/none"}) {
    const Result r = Run(STG_CHECK_TRACE, what);
    EXPECT_EQ(r.code, 2);
    EXPECT_NE(r.err.find("config.yaml"), std::string::npos) << r.err;
  }
  EXPECT_NE(Run(STG_CHECK_TRACE, "").code, 0);
}

}  // namespace
}  // namespace stg::env

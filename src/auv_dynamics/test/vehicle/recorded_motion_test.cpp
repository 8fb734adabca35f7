#include "auv_dynamics/playback/recorded_motion.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"

namespace stg::dynamics {
namespace {

constexpr char kTitle[] =
    "rpm,rudder_deg,stern_deg,Vc,beta_deg,t,x,y,z,phi,theta,psi,u,v,w,p,q,r\n";
constexpr char kRestAt1[] = "0,0,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n";

class MotionFile : public ::testing::Test {
 protected:
  void SetUp() override { file_ = folder_ + "/motion.csv"; }

  void Write(const std::string& text) const { std::ofstream(file_) << text; }
  std::string Refusal(const std::string& text) const {
    Write(text);
    try {
      LoadMotions(file_);
    } catch (const UserError& e) {
      return e.what();
    }
    return "accepted";
  }
  int Run(const std::string& arguments) {
    const std::string out = folder_ + "/stdout";
    const int status = std::system(
        ("'" STG_CHECK_VEHICLE "' " + arguments + " > '" + out + "' 2> '" + folder_ + "/stderr'")
            .c_str());
    out_ = Read(out);
    err_ = Read(folder_ + "/stderr");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  nlohmann::json Json() const {
    std::istringstream in(out_);
    std::string line, last;
    while (std::getline(in, line)) last = line;
    return nlohmann::json::parse(last, nullptr, false);
  }
  static std::string Read(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }

  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
  std::string file_, out_, err_;
};

TEST_F(MotionFile, CommandsAndTimesPartTheMotions) {
  Write(std::string(kTitle) + kRestAt1 + "0,0,0,0,0,2,0,0,0,0,0,0,0,0,0,0,0,0\r\n" +
        "0,0,0,0,0,2,0,0,0,0,0,0,0,0,0,0,0,0\n" + "0,5,0,0,0,3,0,0,0,0,0,0,0,0,0,0,0,0\n");
  const auto motions = LoadMotions(file_);
  ASSERT_EQ(motions.size(), 3u);
  EXPECT_EQ(motions[0].rows.size(), 2u);
  EXPECT_EQ(motions[1].rows[0].line, 4);
  EXPECT_EQ(motions[2].rudder_deg, 5.0);
}

TEST_F(MotionFile, MayBeginWithAByteOrderMark) {
  Write("\xEF\xBB\xBF" + std::string(kTitle) + kRestAt1);
  const auto motions = LoadMotions(file_);
  ASSERT_EQ(motions.size(), 1u);
  EXPECT_EQ(motions[0].rows[0].line, 2);
}

TEST_F(MotionFile, SaysWhatIsWrongAndWhere) {
  EXPECT_NE(Refusal("").find("contains no motion"), std::string::npos);
  EXPECT_NE(Refusal("a,b\n").find(":1: expected the header"), std::string::npos);
  EXPECT_NE(Refusal(kTitle).find("contains no motion"), std::string::npos);
  const std::string title = kTitle;
  EXPECT_NE(Refusal(title + "0,0,0,0,0,1,0,0\n").find(":2: after column y: expected a comma"),
            std::string::npos);
  EXPECT_NE(Refusal(title + kRestAt1 + "0,0,0,0,0,2,0,nan,0,0,0,0,0,0,0,0,0,0\n")
                .find(":3: column y: expected a finite number"),
            std::string::npos);
  EXPECT_NE(
      Refusal(title + "0,0,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0,0\n").find("more cells than the header"),
      std::string::npos);
  EXPECT_NE(Refusal(title + "0,0,0,0,0,-1,0,0,0,0,0,0,0,0,0,0,0,0\n").find("column t"),
            std::string::npos);
  EXPECT_NE(Refusal(title + "0,0,0,0,0,1e9,0,0,0,0,0,0,0,0,0,0,0,0\n").find("column t"),
            std::string::npos);
  EXPECT_NE(
      Refusal(title + "1e9,0,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n").find("column rpm: out of range"),
      std::string::npos);
  for (const char* far : {"1e300,0,0,0,0,0,0,0,0,0,0,0", "0,0,0,0,-1e300,0,0,0,0,0,0,0",
                          "0,0,0,0,0,0,0,0,0,0,0,1e300"}) {
    EXPECT_NE(Refusal(title + "0,0,0,0,0,1," + far + "\n").find(": out of range"),
              std::string::npos)
        << far;
  }
  EXPECT_NE(Refusal(title + "\n" + kRestAt1).find(":2: column rpm"), std::string::npos);
  std::filesystem::remove(file_);
  EXPECT_THROW(LoadMotions(file_), UserError);
  EXPECT_THROW(LoadMotions(folder_), UserError);
  std::ofstream(file_) << 'x';
  std::filesystem::resize_file(file_, 1ULL << 40);  // sparse
  EXPECT_THROW(LoadMotions(file_), UserError);
}

TEST_F(MotionFile, AVehicleAtRestHasNoError) {
  Write(std::string(kTitle) + kRestAt1);
  const MotionError e = Compare(VehicleConfig(), LoadMotions(file_), 0.05);
  EXPECT_TRUE(e.Within(0.0));
  EXPECT_EQ(e.rows, 1);
}

TEST_F(MotionFile, AColumnThatMovesWhereNoneShouldIsInfinitelyWrong) {
  Write(std::string(kTitle) + "500,0,0,0,0,5,0,0,0,0,0,0,0,0,0,0,0,0\n");
  const MotionError e = Compare(VehicleConfig(), LoadMotions(file_), 0.05);
  EXPECT_TRUE(std::isinf(e.columns[kU].share()));
  EXPECT_FALSE(e.Within(1e9));
}

TEST_F(MotionFile, ToolRefusesWhatItCannotCompareWith) {
  const std::string shipped = "'" STG_TEST_DATA "/remus100.csv'";
  for (const char* wrong : {"--dt nan", "--dt 0", "--tolerance nan", "--tolerance -1"}) {
    EXPECT_EQ(Run(shipped + " " + wrong), 2);
    EXPECT_NE(err_.find(" is not from "), std::string::npos) << err_;
  }
  const std::string scenarios = STG_SHIPPED_TERRAIN "/../scenarios/";
  EXPECT_EQ(Run(shipped + " --scenario '" + scenarios + "medium.yaml'"), 2);
  EXPECT_NE(err_.find("has the model fully_actuated"), std::string::npos) << err_;
  const std::string field = shipped + " --scenario '" + scenarios + "field.yaml'";
  EXPECT_EQ(Run(field), 0) << err_;
  for (const auto& [options, message] :
       {std::pair(" --set sensing.range_m=3", "check_vehicle reads only the keys vehicle.*"),
        std::pair(" --set vehicle.radius_m=1", "a motion of a torpedo does not depend on this key"),
        std::pair(" --set vehicle.integrator=rk4", "use the option --integrator in place")}) {
    EXPECT_EQ(Run(field + options), 2);
    EXPECT_NE(err_.find(message), std::string::npos) << err_;
  }
}

TEST_F(MotionFile, ToolEndsWithItsResultUnderAnyNameAndFailsWhereItCannotBeWritten) {
  const std::string latin = folder_ + "/\xe9.csv";
  std::filesystem::copy_file(STG_TEST_DATA "/remus100.csv", latin);
  EXPECT_EQ(Run("'" + latin + "'"), 0) << err_;
  EXPECT_TRUE(Json().is_object()) << out_;
  const int status = std::system("'" STG_CHECK_VEHICLE "' '" STG_TEST_DATA
                                 "/remus100.csv' > /dev/full 2> /dev/null");
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 2) << status;
}

TEST_F(MotionFile, ToolReportsByColumnAndByExitStatus) {
  const std::string shipped = "'" STG_TEST_DATA "/remus100.csv'";
  EXPECT_EQ(Run(shipped), 0) << err_;
  nlohmann::json json = Json();
  ASSERT_FALSE(json.is_discarded());
  EXPECT_TRUE(json["pass"].get<bool>());
  EXPECT_EQ(json["motions"], 7);
  EXPECT_EQ(json["in_current"]["motions"], 1);
  EXPECT_LT(json["columns"]["r"]["share"].get<double>(), 0.01);
  EXPECT_EQ(Run(shipped + " --tolerance 1e-9"), 1);
  EXPECT_FALSE(Json()["pass"].get<bool>());
  EXPECT_EQ(Run("--help"), 0);
  EXPECT_NE(out_.find("--tolerance"), std::string::npos);
  EXPECT_EQ(Run(""), 2);
  EXPECT_EQ(Run("'" + folder_ + "/none.csv'"), 2);
  EXPECT_NE(err_.find("none.csv: no such file"), std::string::npos);
  EXPECT_EQ(Run(shipped + " --set vehicle.substeps=2"), 2);
  EXPECT_NE(err_.find("--set requires --scenario"), std::string::npos) << err_;
}

}  // namespace
}  // namespace stg::dynamics

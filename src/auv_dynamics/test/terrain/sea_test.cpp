#include "auv_dynamics/world/sea.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "auv_dynamics/world/current.hpp"
#include "physics.hpp"

namespace stg::dynamics {
namespace {

/// Open water for vehicles that follow each command at once.
WorldScenario OpenWater(int agents) {
  WorldScenario s = QuietScenario(agents);
  s.world.vehicle.model = "kinematic";
  s.world.vehicle.max_velocity_mps = {2.0, 2.0, 1.0};
  s.world.vehicle.max_rate_radps = {0.5, 0.5, 0.2};
  s.world.workspace.half_extent_m = 500.0;
  s.world.sea.open = true;
  s.world.target.max_speed_mps = 1.0;
  s.world.reset.start_half_extent_m = 500.0;
  s.world.reset.min_separation_m = 20.0;
  for (ResetStageConfig& stage : s.world.reset.stages)
    stage = {{0.0, 100.0}, {50.0, 150.0}, {0.3, 0.9}};
  return s;
}

double East(const Current& current, double z, double time_s) {
  return Lane(current.At(Pack(z), Pack(time_s)), 0).x;
}

TEST(Current, IsLinearBetweenItsLayersAndConstantBeyond) {
  CurrentConfig c;
  c.velocity_mps = {0.1, 0.2, 0.3};
  EXPECT_TRUE(Current(c).uniform());
  c.layer_depth_m = {10.0, 20.0, 40.0, 50.0};
  c.layer_east_mps = {1.0, 0.5, 0.5, 0.0};
  const Current current(c);
  EXPECT_FALSE(current.uniform());
  const double table[][2] = {{0.0, 1.0},  {10.0, 1.0},  {15.0, 0.75}, {20.0, 0.5},
                             {30.0, 0.5}, {45.0, 0.25}, {50.0, 0.0},  {500.0, 0.0}};
  for (const auto& [depth, east] : table) {
    EXPECT_NEAR(East(current, -depth, 0.0), 0.1 + east, 1e-12) << depth;
  }
  EXPECT_EQ(Lane(current.At(Pack(-15.0), Pack(9.0)), 0).z, 0.3);
  c.layer_depth_m[2] = 20.0;
  EXPECT_TRUE(FindConflict(c).has_value());
}

TEST(Current, IsNeverFasterThanItsLargestSpeedAndReachesIt) {
  CurrentConfig c;
  c.velocity_mps = {0.3, 0.0, 0.4};
  EXPECT_NEAR(c.largest_mps(), 0.5, 1e-12);
  c.velocity_mps = {0.1, 0.0, 0.0};
  c.layer_depth_m = {10.0, 20.0, 40.0, 50.0};
  c.layer_east_mps = {0.2, 0.6, 0.0, 0.0};
  c.tide_mps = {0.2, 0.0};
  EXPECT_NEAR(c.largest_mps(), 0.9, 1e-12);
  EXPECT_NEAR(East(Current(c), -20.0, 0.0), 0.9, 1e-12) << "all parts flow eastward there";
  c.random_mps = {0.0, 0.4};
  c.random_tide_mps = 0.1;
  EXPECT_NEAR(c.largest_mps(), 1.4, 1e-12);
  Current current(c);
  double fastest = 0.0;
  for (std::uint32_t episode = 0; episode < 300; ++episode) {
    current.Reset(0, 1, episode);
    for (const double depth : {0.0, 10.0, 15.0, 20.0, 30.0, 60.0}) {
      const auto v = Lane(current.At(Pack(-depth), Pack(97.0 * episode)), 0);
      fastest = std::max(fastest, std::hypot(v.x, v.y));
    }
  }
  EXPECT_LE(fastest, c.largest_mps());
  EXPECT_GT(fastest, 0.8 * c.largest_mps());
}

TEST(Current, TideCarriesADriftingVehicleToAndFro) {
  WorldScenario s = OpenWater(1);
  s.run.time.dt_s = 0.1;
  s.world.current.tide_mps = {0.5, -0.2};
  s.world.current.tide_period_s = 200.0;
  World world(s);
  world.Place(0, {{0.0, 0.0, -30.0}}, {{50.0, 0.0, -30.0}}, {{0.0, 0.0, 0.0}});
  const std::vector<Pack> still(3, Pack(0.0));
  for (int k = 0; k < 500; ++k) world.Step(still);  // a quarter of the tide's period
  const double amplitude = 0.5 * 200.0 / (2.0 * kPi);
  EXPECT_NEAR(world.Nav(0, 0).p_WB.x, amplitude, 0.05);
  EXPECT_NEAR(world.Nav(0, 0).p_WB.y, -0.4 * amplitude, 0.05);
  for (int k = 0; k < 1500; ++k) world.Step(still);
  EXPECT_NEAR(world.Nav(0, 0).p_WB.x, 0.0, 0.05);
}

TEST(Sea, StopsAtSurfaceAndBottomAndCountsGroundings) {
  World world(OpenWater(2));
  world.Place(0, {{0.0, 0.0, -118.0}, {0.0, 50.0, -2.0}}, {{50.0, 0.0, -30.0}}, {{0.0, 0.0, 0.0}});
  const auto steer = [&world](double first, double second, int steps) {
    const std::vector<Pack> commands{Pack(1.0), Pack(0.0), Pack(first),
                                     Pack(1.0), Pack(0.0), Pack(second)};
    for (int k = 0; k < steps; ++k) world.Step(commands);
  };
  steer(-1.0, 1.0, 100);
  EXPECT_EQ(world.Nav(0, 0).p_WB.z, -120.0);
  EXPECT_EQ(world.Nav(0, 1).p_WB.z, 0.0);
  EXPECT_EQ(Lane(world.vehicle(0).v_WB.z, 0), 0.0);
  EXPECT_EQ(Lane(world.vehicle(1).v_WB.z, 0), 0.0);
  EXPECT_GT(world.Nav(0, 0).v_WB_B.x, 0.9);  // it goes on along the bottom
  EXPECT_EQ(Lane(world.sea().groundings(0), 0), 1.0);
  EXPECT_EQ(Lane(world.sea().aground(0), 0), 1.0);
  EXPECT_EQ(Lane(world.sea().groundings(1), 0), 0.0);
  steer(1.0, 1.0, 100);
  EXPECT_EQ(Lane(world.sea().aground(0), 0), 0.0);
  steer(-1.0, 1.0, 200);
  EXPECT_EQ(Lane(world.sea().groundings(0), 0), 2.0);
  world.Reset(0, 3, 0, ResetStage::kMedium);
  EXPECT_EQ(Lane(world.sea().groundings(0), 0), 0.0);
}

TEST(Sea, HasNoWalls) {
  World world(OpenWater(1));
  world.Place(0, {{490.0, 0.0, -30.0}}, {{495.0, 0.0, -30.0}}, {{1.0, 0.0, 0.0}});
  for (int k = 0; k < 1000; ++k) world.Step({Pack(2.0), Pack(0.0), Pack(0.0)});
  EXPECT_GT(world.Nav(0, 0).p_WB.x, 680.0);
  EXPECT_NEAR(Lane(world.target(0).p_WT.x, 0), 595.0, 1e-9);
}

TEST(Sea, EpisodesStartAtTheirDepthsApartFromEachOther) {
  WorldScenario s = OpenWater(6);
  s.world.sea.auv_depth_m = {10.0, 15.0};
  s.world.sea.target_depth_m = {40.0, 50.0};
  s.world.target.count = 2;
  World world(s);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    world.Reset(0, seed, 0, ResetStage::kMedium);
    for (int i = 0; i < 6; ++i) {
      const Vec3<double> p = world.Nav(0, i).p_WB;
      EXPECT_LE(p.z, -10.0);
      EXPECT_GE(p.z, -15.0);
      const Vec3<double> t = Lane(world.target(i % 2).p_WT, 0);
      const double distance = std::hypot(p.x - t.x, p.y - t.y);
      EXPECT_GE(distance, 50.0 - 1e-9);
      EXPECT_LE(distance, 150.0 + 1e-9);
    }
    EXPECT_GE(Lane(world.smallest_separation(), 0), 20.0);
    for (int k = 0; k < 2; ++k) {
      EXPECT_LE(Lane(world.target(k).p_WT.z, 0), -40.0);
      EXPECT_GE(Lane(world.target(k).p_WT.z, 0), -50.0);
      EXPECT_EQ(Lane(world.target(k).v_WT.z, 0), 0.0);
    }
  }
}

TEST(Sea, DeployedFromOnePlaceVehiclesStandInALine) {
  WorldScenario s = OpenWater(5);
  s.world.reset.deploy = Deploy::kPoint;
  World world(s);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    world.Reset(0, seed, 0, ResetStage::kMedium);
    const Vec3<double> t = Lane(world.target(0).p_WT, 0), middle = world.Nav(0, 2).p_WB;
    const double distance = std::hypot(middle.x - t.x, middle.y - t.y);
    EXPECT_GE(distance, 50.0 - 1e-9);
    EXPECT_LE(distance, 150.0 + 1e-9);
    const Vec3<double> step = world.Nav(0, 1).p_WB - world.Nav(0, 0).p_WB;
    EXPECT_NEAR(std::hypot(step.x, step.y), 20.0, 1e-9);
    for (int i = 0; i < 5; ++i) {
      const Vec3<double> p = world.Nav(0, i).p_WB;
      EXPECT_NEAR(p.x, middle.x + (i - 2) * step.x, 1e-9);
      EXPECT_NEAR(p.y, middle.y + (i - 2) * step.y, 1e-9);
    }
  }
}

TEST(Sea, DeployedInAnAreaVehiclesStartAnywhereInIt) {
  WorldScenario s = OpenWater(4);
  s.world.reset.deploy = Deploy::kArea;
  World world(s);
  int far = 0;
  double least = 0.0, most = 0.0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    world.Reset(0, seed, 0, ResetStage::kMedium);
    const Vec3<double> t = Lane(world.target(0).p_WT, 0);
    for (int i = 0; i < 4; ++i) {
      const Vec3<double> p = world.Nav(0, i).p_WB;
      EXPECT_LE(std::max(std::abs(p.x), std::abs(p.y)), 500.0);
      least = std::min(least, p.x);
      most = std::max(most, p.x);
      far += std::hypot(p.x - t.x, p.y - t.y) > 150.0 ? 1 : 0;
    }
  }
  // The ring around the target, where AUVs start otherwise, is a small part of the square.
  EXPECT_GT(far, 300);
  EXPECT_LT(least, -450.0);
  EXPECT_GT(most, 450.0);
}

TEST(Sea, TargetsOfEveryMotionKeepTheirDepthAndSpeed) {
  for (const std::string& motion : TargetMotions().Names()) {
    if (motion == "lift") continue;  // another test registers it
    WorldScenario s = OpenWater(1);
    s.world.target.motion = motion;
    if (motion == "evasive") config::Override(&s, {"target.evasive.range_m=300"});
    World world(s);
    world.Reset(0, 9, 0, ResetStage::kMedium);
    const double speed = Norm(Lane(world.target(0).v_WT, 0));
    for (int k = 0; k < 6000; ++k) {
      world.Step({Pack(1.0), Pack(0.02), Pack(0.0)});
      const TargetState<Pack>& t = world.target(0);
      ASSERT_LE(Lane(t.p_WT.z, 0), -20.0) << motion;
      ASSERT_GE(Lane(t.p_WT.z, 0), -60.0) << motion;
      ASSERT_NEAR(Norm(Lane(t.v_WT, 0)), speed, 1e-6) << motion;
    }
  }
}

/// A folder with `slope.nc`. Its sea is 10 m deep at the southern edge and 210 m at the northern
/// edge, 22 km away.
class SeaOverAFile : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<double> lats, lons;
    std::vector<float> elevation;
    for (int k = 0; k <= 20; ++k) {
      lats.push_back(10.0 + 0.01 * k);
      lons.push_back(50.0 + 0.01 * k);
    }
    for (int r = 0; r <= 20; ++r) {
      for (int c = 0; c <= 20; ++c) elevation.push_back(static_cast<float>(-10 - 10 * r));
    }
    Bathymetry(lats, lons, elevation).Save(folder_ + "/slope.nc", "for a test");
    ::setenv("STG_TERRAINS", ("/no/such:" + folder_).c_str(), 1);
  }
  void TearDown() override { ::unsetenv("STG_TERRAINS"); }
  static WorldScenario Slope(double latitude) {
    WorldScenario s = OpenWater(1);
    s.world.sea.terrain = "slope";
    s.world.sea.latitude_deg = latitude;
    s.world.sea.longitude_deg = 50.1;
    return s;
  }
  static std::string Refusal(const WorldScenario& s) {
    try {
      World world(s);
      world.Reset(0, 1, 0, ResetStage::kMedium);
    } catch (const UserError& e) {
      return e.what();
    }
    return "accepted";
  }
  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
};

TEST_F(SeaOverAFile, TheBottomIsThatOfTheFile) {
  World world(Slope(10.1));
  EXPECT_NEAR(world.sea().terrain().Height(0.0, 0.0), -110.0, 0.1);
  // Each hundredth of a degree to the north, 1106 m, adds 10 m of depth.
  EXPECT_NEAR(world.sea().terrain().Height(0.0, 400.0), -110.0 - 4.0 / 1.106, 0.1);
  world.Place(0, {{0.0, 300.0, -105.0}}, {{50.0, 0.0, -30.0}}, {{0.0, 0.0, 0.0}});
  for (int k = 0; k < 300; ++k) world.Step({Pack(1.0), Pack(0.0), Pack(-1.0)});
  const Vec3<double> p = world.Nav(0, 0).p_WB;
  EXPECT_NEAR(p.z, world.sea().terrain().Height(p.x, p.y), 1e-3);
  EXPECT_NEAR(p.z, -110.0 - 3.0 / 1.106, 0.1);
  EXPECT_EQ(Lane(world.sea().groundings(0), 0), 1.0);
}

TEST_F(SeaOverAFile, EpisodesStartClearOfTheBottomOrSayThatTheyCannot) {
  WorldScenario s = Slope(10.05);  // the water is 60 m deep
  s.world.sea.auv_depth_m = s.world.sea.target_depth_m = {20.0, 80.0};
  World world(s);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    world.Reset(0, seed, 0, ResetStage::kMedium);
    EXPECT_GT(world.sea().terrain().Altitude(world.Nav(0, 0).p_WB), 5.0);
    EXPECT_GT(world.sea().terrain().Altitude(Lane(world.target(0).p_WT, 0)), 5.0);
  }
  s.world.sea.target_depth_m = {70.0, 80.0};
  EXPECT_NE(Refusal(s).find("every start of a target lies in the bottom"), std::string::npos);
  EXPECT_NE(Refusal(s).find("the water is 60."), std::string::npos) << Refusal(s);
  s.world.sea.target_depth_m = {20.0, 40.0};
  s.world.sea.auv_depth_m = {70.0, 80.0};
  EXPECT_NE(Refusal(s).find("no room for 1 vehicles"), std::string::npos);
}

TEST_F(SeaOverAFile, TakesAFileByItsPathWhateverItsName) {
  // GEBCO gives a file of this form of name to a user who cuts out a part.
  const std::string file = folder_ + "/gebco_2024_n10.5_s9.5.nc";
  std::filesystem::copy_file(folder_ + "/slope.nc", file);
  WorldScenario s = Slope(10.1);
  s.world.sea.terrain = file;
  EXPECT_EQ(Refusal(s), "accepted");
  s.world.sea.terrain = folder_ + "/none.nc";
  EXPECT_NE(Refusal(s).find("no file " + folder_), std::string::npos) << Refusal(s);
  for (const std::string bad : {"two words.nc", ".nc", "x.nc\n", "../passwd", "-x.nc"}) {
    s.world.sea.terrain = bad;
    EXPECT_NE(Refusal(s).find("is not a name"), std::string::npos) << bad;
  }
  s = Slope(10.1);
  s.run.name = file;  // other texts must be plain names
  EXPECT_NE(Refusal(s).find("is not a name"), std::string::npos);
}

TEST_F(SeaOverAFile, SaysWhatIsWrong) {
  WorldScenario s = Slope(10.1);
  EXPECT_EQ(Refusal(s), "accepted");
  s.world.sea.latitude_deg = 11.0;
  EXPECT_NE(Refusal(s).find("covers latitudes 10.0"), std::string::npos) << Refusal(s);
  s = Slope(10.1);
  s.world.sea.longitude_deg = 40.0;
  EXPECT_NE(Refusal(s).find("covers longitudes 50.0"), std::string::npos) << Refusal(s);
  s.world.sea.terrain = "atlantis";
  ::setenv("STG_SCENARIOS", folder_.c_str(), 1);
  EXPECT_NE(Refusal(s).find("no atlantis.nc in the folders of STG_TERRAINS"), std::string::npos);
  ::unsetenv("STG_SCENARIOS");
  std::ofstream(folder_ + "/slope.nc") << "no grid";
  EXPECT_NE(Refusal(Slope(10.1)).find("not a readable NetCDF file"), std::string::npos);
}

TEST(Sea, RefusesStartsInTheBottom) {
  WorldScenario s = OpenWater(1);
  s.world.sea.bottom_m = 60.0;
  EXPECT_THROW(World{s}, UserError);
  s.world.sea.bottom_m = 100.0;
  s.world.sea.target_depth_m = {20.0, 100.0};
  EXPECT_THROW(World{s}, UserError);
  s.world.sea.open = false;
  EXPECT_NO_THROW(World{s});
}

}  // namespace
}  // namespace stg::dynamics

// Which AUV goes up for a fix, when it goes, and how fast it climbs.

#include "stg_agent/localization/surfacing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "stg_agent/agent_config.hpp"
#include "stg_agent/estimation/target_filter.hpp"

namespace stg::agent {
namespace {

constexpr TimeNs kOneSecond = 1'000'000'000;
constexpr double kLimit_m = 25.0, kGrowth_mps = 0.1, kDepth_m = 20.0;

AgentModel SurfacingModel() {
  AgentScenario s;
  s.run.agents = 4;
  s.world.vehicle.max_velocity_mps = {2.0, 2.0, 0.5};
  s.agent.localization.kind = "ranges";
  s.agent.localization.surface_std_m = kLimit_m;
  return s.model();
}

/// A localizer whose deviation grows by 0.1 m per second after the last fix.
class Growing : public Localizer {
 public:
  void Reset() override {}
  void Hear(const NeighbourState&, const acoustics::Reception&) override {}
  void HearAnswer(const acoustics::Reception&) override {}
  void Advance(TimeNs now, const OwnReckoning&) override { now_ = now; }
  PlaneError own() const override { return ahead(0.0); }
  PlaneError ahead(double ahead_s) const override {
    const double std_m = kGrowth_mps * (Seconds(now_ - std::max<TimeNs>(fixed_, 0)) + ahead_s);
    PlaneError e;
    e.xx = e.yy = std_m * std_m;
    return e;
  }
  int fixes() const override { return fixed_ < 0 ? 0 : 1; }
  TimeNs fixed() const override { return fixed_; }
  PlaneError relative(int, TimeNs) const override { return {}; }
  PlaneError current() const override { return {}; }
  void Tell(NeighbourState*) const override {}
  Vec3<double> NearTo(int) const override { return {}; }

  TimeNs fixed_ = -1;

 private:
  TimeNs now_ = 0;
};

NeighbourState Said(int id, double t, double depth_m, bool surfacing = false) {
  NeighbourState s;
  s.source = id;
  s.generation = static_cast<TimeNs>(t * 1e9);
  s.p_W.z = -depth_m;
  s.surfacing = surfacing;
  return s;
}

/// One AUV that moves as commanded.
struct Flown {
  explicit Flown(int self) : law(SurfacingModel(), self) { law.Reset(); }

  void To(int t) {
    for (; now < t; ++now) {
      localizer.Advance(now * kOneSecond, {});
      law.Advance(now * kOneSecond, {0.0, 0.0, -depth_m}, localizer);
      if (law.under_way()) depth_m = std::max(0.0, depth_m - 0.5 * law.climb_share());
      if (law.announces() && began < 0) began = now;
      if (depth_m < 0.3 && surfaced < 0) surfaced = now;
      if (surfaced >= 0 && now == surfaced + 30) localizer.fixed_ = now * kOneSecond;
    }
  }

  Surfacing law;
  Growing localizer;
  int now = 0, began = -1, surfaced = -1;
  double depth_m = kDepth_m;
};

// The deviation is 25 m at 250 s, as it grows by 0.1 m/s. The AUV starts 70 s earlier: it climbs 20
// m at 0.5 m/s and waits 30 s for the fix.
TEST(Surfacing, AnAuvGoesUpInTimeForItsFixAndBackDown) {
  Flown auv(2);
  auv.To(181);
  EXPECT_EQ(auv.began, -1);
  EXPECT_FALSE(auv.law.under_way());
  auv.To(270);
  EXPECT_NEAR(auv.began, 181, 1);
  // The last metre of the climb is slow.
  EXPECT_NEAR(auv.surfaced, 181 + 40, 8);
  EXPECT_FALSE(auv.law.announces());
  EXPECT_TRUE(auv.law.under_way());
  EXPECT_LT(auv.law.climb_share(), 0.0);
  auv.To(340);
  EXPECT_FALSE(auv.law.under_way());
  EXPECT_NEAR(auv.depth_m, kDepth_m, 1.0);
  EXPECT_EQ(auv.law.climb_share(), 0.0);
}

TEST(Surfacing, TheShallowestGoesAndOfEqualOnesTheLowestIndex) {
  for (const bool equal : {false, true}) {
    Flown lower(1), higher(2);
    for (int t = 5; t <= 300; t += 5) {
      lower.law.Hear(Said(2, t - 2, equal ? kDepth_m : kDepth_m + 10.0));
      higher.law.Hear(Said(1, t - 2, equal ? kDepth_m : kDepth_m - 10.0));
      lower.To(t);
      higher.To(t);
      if (t == 200) {
        EXPECT_TRUE(lower.law.announces());
        EXPECT_FALSE(higher.law.announces());
      }
    }
    // No AUV has announced a climb. A minute later the next AUV goes.
    EXPECT_NEAR(higher.began, 241, 5);
  }
}

TEST(Surfacing, NobodyGoesWithinFiveMinutesOfAnAnnouncement) {
  Flown auv(0);
  auv.law.Hear(Said(3, 100.0, 5.0, true));
  auv.To(401);
  EXPECT_EQ(auv.began, -1);
  // The AUV that announced its climb was not heard again, so this AUV knows no other.
  auv.To(420);
  EXPECT_NEAR(auv.began, 401, 1);
}

TEST(Surfacing, ALowerIndexHasTheRightOfWay) {
  for (const int other : {1, 3}) {
    Flown auv(2);
    auv.To(200);
    ASSERT_TRUE(auv.law.announces());
    auv.law.Hear(Said(other, 199.0, 30.0, true));
    auv.To(202);
    EXPECT_EQ(auv.law.announces(), other == 3);
    EXPECT_TRUE(auv.law.under_way());
  }
}

TEST(Surfacing, WithoutAFixItGivesUp) {
  Flown auv(0);
  for (; auv.now < 500;) {
    auv.To(auv.now + 1);
    auv.depth_m = std::max(auv.depth_m, 5.0);  // the AUV is held down
  }
  EXPECT_NEAR(auv.began, 181, 1);
  EXPECT_FALSE(auv.law.announces());
}

TEST(Surfacing, TheOrderOfPacketsDoesNotMatter) {
  Flown a(2), b(2);
  const NeighbourState older = Said(1, 40.0, 10.0, true), newer = Said(1, 150.0, 30.0);
  a.law.Hear(older);
  a.law.Hear(newer);
  b.law.Hear(newer);
  b.law.Hear(older);
  a.To(500);
  b.To(500);
  EXPECT_EQ(a.began, b.began);
  EXPECT_NEAR(a.began, 341, 1);
}

TEST(Surfacing, IsRefusedWhereItCannotBe) {
  const auto conflict = [](const auto& change) {
    AgentScenario s;
    s.run.agents = 4;
    s.channel.model = "physical";
    s.world.sea.open = true;
    s.world.navigation.kind = "dead_reckoning";
    s.world.navigation.fixes = dynamics::FixUse::kReported;
    s.agent.track.filter = "measurements";
    s.agent.track.observers = ObserverErrors::kLocated;
    s.agent.localization.kind = "ranges";
    s.agent.localization.surface_std_m = kLimit_m;
    change(&s);
    const auto violation = FindLocalizationConflict(s.model());
    return violation ? violation->keys.front() : std::string();
  };
  EXPECT_EQ(conflict([](AgentScenario*) {}), "");
  const std::string key = "localization.ranges.surface_std_m";
  EXPECT_EQ(conflict([](AgentScenario* s) { s->world.sea.open = false; }), key);
  EXPECT_EQ(conflict([](AgentScenario* s) { s->world.navigation.gps_depth_m = 0.0; }), key);
  EXPECT_EQ(conflict([](AgentScenario* s) {
              s->world.control.interface = dynamics::ActionInterface::kTau6;
            }),
            key);
  EXPECT_EQ(
      conflict([](AgentScenario* s) { s->world.navigation.fixes = dynamics::FixUse::kCorrect; }),
      "localization.kind");
}

}  // namespace
}  // namespace stg::agent

// The localizer between packets and filter. A measurement counts once, even if packets come late,
// twice or in another order. An AUV that gets no position in the world must not claim to know one.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "acoustic_channel/access/medium_access.hpp"
#include "stg_agent/agent_config.hpp"
#include "stg_agent/localization/localizer.hpp"

namespace stg::agent {
namespace {

constexpr double kSound_mps = 1500.0;
constexpr TimeNs kSecond = 1'000'000'000;

AgentModel Model(int auvs, bool craft) {
  AgentScenario s;
  s.run.agents = auvs;
  s.run.time.dt_s = 0.5;
  s.run.time.decision_steps = 2;
  s.world.navigation.kind = "dead_reckoning";
  s.world.navigation.current_std_mps = 0.2;
  s.world.navigation.gps_depth_m = 0.0;
  s.channel.physical.water.sound_speed = acoustics::WaterConfig::SoundSpeed::kProfile;
  s.channel.physical.water.profile_speeds_mps.fill(kSound_mps);
  s.agent.localization.kind = "ranges";
  if (craft) s.agent.stations.crafts = {{0.0, 0.0}};
  return s.model();
}

/// A packet on its way to AUV 0.
struct Letter {
  NeighbourState state;
  acoustics::Reception reception;
};

/// AUVs on circles of 90 m, which a current carries at 0.3 m/s. AUV 0 hears one packet a second.
class Flight {
 public:
  explicit Flight(const AgentModel& model) : model_(model) {}

  Vec3<double> True(int id, double t) const {
    if (id >= model_.run.agents) {
      return {300.0 * std::cos(0.005 * t), 300.0 * std::sin(0.005 * t), 0.0};
    }
    const double angle = 1.6 * id + (0.010 + 0.001 * id) * t;
    return {90.0 * std::cos(angle), 90.0 * std::sin(angle), -20.0 - 10.0 * id};
  }
  Vec3<double> Overheard(int id, double t) const {
    if (id >= model_.run.agents) return True(id, t);
    return True(id, t) + Vec3<double>{-0.3 * t - 0.02 * id * t, 0.1 * t, 0.0};
  }
  Vec3<double> Speed(int id, double t) const {
    return (Overheard(id, t + 0.01) - Overheard(id, t - 0.01)) * 50.0;
  }
  /// The packet that AUV 0 hears in the second before t.
  Letter At(int t) const {
    const int source = 1 + t % (model_.members() - 1);
    Letter l;
    l.state.source = source;
    l.state.generation = (t - 1) * kSecond;
    l.state.p_W = Overheard(source, t - 1.0);
    l.state.v_W = Speed(source, t - 1.0);
    l.state.position_std_m = 0.3 * t;
    l.state.adrift = source < model_.run.agents;
    l.reception.source = source;
    l.reception.transmit = l.state.generation + kSecond / 4;
    l.reception.arrival = l.state.generation + kSecond / 2;
    const double sent = t - 0.75;
    l.reception.travel_time_s = Norm(True(source, sent) - True(0, sent)) / kSound_mps;
    if (source < model_.run.agents && t > 20) {
      // It has heard another AUV a while ago.
      const int other = 1 + (t - 2) % (model_.members() - 1);
      const double then = t - 2.75;
      if (other != source) {
        l.state.ranges.push_back({other, l.state.generation - 7 * kSecond / 4,
                                  Norm(True(other, then) - True(source, then))});
      }
    }
    return l;
  }
  OwnReckoning Own(int t) const { return {Overheard(0, t), std::hypot(1.0, 0.2 * t)}; }

 private:
  AgentModel model_;
};

void Advance(const Flight& flight, int t, const std::vector<Letter>& letters, Localizer* l) {
  for (const Letter& letter : letters) l->Hear(letter.state, letter.reception);
  l->Advance(t * kSecond, flight.Own(t));
}

TEST(RangeLocalizer, FindsTheDriftWithACraft) {
  const AgentModel model = Model(4, true);
  const Flight flight(model);
  const auto localizer = MakeLocalizer(model, 0);
  localizer->Reset();
  for (int t = 0; t <= 900; ++t) {
    std::vector<Letter> letters;
    if (t > 0) letters.push_back(flight.At(t));
    Advance(flight, t, letters, localizer.get());
  }
  const PlaneError own = localizer->own();
  EXPECT_NEAR(own.x, -0.3 * 900.0, 5.0);
  EXPECT_NEAR(own.y, 0.1 * 900.0, 5.0);
  EXPECT_LT(own.std_m(), 6.0);
  // The current is minus the drift of the reckoned position.
  EXPECT_NEAR(localizer->current().x, 0.3, 0.1);
  const PlaneError other = localizer->relative(2, 900 * kSecond);
  EXPECT_NEAR(other.x, -0.02 * 2.0 * 900.0, 2.0);
  EXPECT_NEAR(other.y, 0.0, 2.0);
}

TEST(RangeLocalizer, AloneItKnowsTheOthersAndStatesThatAllMayBeAway) {
  const AgentModel model = Model(4, false);
  const Flight flight(model);
  const auto localizer = MakeLocalizer(model, 0);
  localizer->Reset();
  for (int t = 0; t <= 900; ++t) {
    std::vector<Letter> letters;
    if (t > 0) letters.push_back(flight.At(t));
    Advance(flight, t, letters, localizer.get());
  }
  EXPECT_NEAR(localizer->relative(3, 900 * kSecond).x, -0.02 * 3.0 * 900.0, 3.0);
  EXPECT_GT(localizer->own().std_m(), 0.19 * 900.0);
}

TEST(RangeLocalizer, WhatComesTwiceOrShuffledWithinADecisionChangesNothing) {
  const AgentModel model = Model(4, true);
  const Flight flight(model);
  const auto once = MakeLocalizer(model, 0), often = MakeLocalizer(model, 0);
  once->Reset();
  often->Reset();
  std::mt19937 random(3);
  std::vector<Letter> seen;
  for (int t = 0; t <= 600; t += 3) {
    // A decision of the test has three packets.
    std::vector<Letter> letters;
    for (int k = t - 2; t > 0 && k <= t; ++k) letters.push_back(flight.At(k));
    Advance(flight, t, letters, once.get());
    for (const Letter& letter : letters) seen.push_back(letter);
    // All packets of the last minute come again, in random order.
    std::vector<Letter> again(
        seen.end() - std::min<std::ptrdiff_t>(60, static_cast<std::ptrdiff_t>(seen.size())),
        seen.end());
    std::shuffle(again.begin(), again.end(), random);
    Advance(flight, t, again, often.get());
  }
  EXPECT_EQ(once->own().x, often->own().x);
  EXPECT_EQ(once->own().xx, often->own().xx);
  EXPECT_EQ(once->relative(2, 600 * kSecond).y, often->relative(2, 600 * kSecond).y);
}

/// AUV 2 has a fix every ten minutes. The fix is wrong by 2 m, and the next three packets tell it.
Letter WithFix(const Flight& flight, int t, double rounding_s) {
  Letter l = flight.At(t);
  const int fixed = (t - 1) / 600 * 600;
  if (l.state.source != 2 || fixed == 0 || t - 1 - fixed > 9) return l;
  l.state.ranges.clear();
  l.state.has_fix = true;
  l.state.fix.stamp =
      fixed * kSecond + static_cast<TimeNs>(rounding_s * static_cast<double>(t % 3 - 1) * 1e9);
  const Vec3<double> error = flight.Overheard(2, fixed) - flight.True(2, fixed);
  l.state.fix.error_x = error.x - 2.0;
  l.state.fix.error_y = error.y;
  l.state.fix.std_m = 3.0;
  return l;
}

TEST(RangeLocalizer, AFixOfAnotherAuvServesThisOneAndCountsOnce) {
  const AgentModel model = Model(4, false);
  const Flight flight(model);
  const auto once = MakeLocalizer(model, 0), often = MakeLocalizer(model, 0),
             never = MakeLocalizer(model, 0);
  for (Localizer* l : {once.get(), often.get(), never.get()}) l->Reset();
  int sent = 0;
  for (int t = 0; t <= 1230; ++t) {
    std::vector<Letter> all, first, none;
    if (t > 0) {
      // Packets round ages to an eighth of a decision.
      all = {WithFix(flight, t, 0.0625)};
      first = all;
      sent = first[0].state.has_fix ? sent + 1 : t % 600 > 20 ? 0 : sent;
      if (sent > 1) first[0].state.has_fix = false;
      none = {flight.At(t)};
      if (all[0].state.has_fix) none[0].state.ranges.clear();
    }
    Advance(flight, t, first, once.get());
    Advance(flight, t, all, often.get());
    Advance(flight, t, none, never.get());
  }
  EXPECT_EQ(once->own().x, often->own().x);
  EXPECT_EQ(once->own().xx, often->own().xx);
  EXPECT_GT(never->own().std_m(), 200.0);
  // Another AUV sent its fix 20 s ago. The fix and the ranges limit the own deviation.
  EXPECT_LT(once->own().std_m(), 5.0);
  EXPECT_GT(once->own().std_m(), 2.5);
  EXPECT_NEAR(once->own().x, -0.3 * 1230.0, 10.0);
  EXPECT_NEAR(once->own().y, 0.1 * 1230.0, 10.0);
  EXPECT_EQ(once->fixes(), 0) << "none is its own";
}

TEST(RangeLocalizer, TheOwnFixIsTakenOnceAndToldInThreeRoundsOfPackets) {
  const AgentModel model = Model(4, true);
  const Flight flight(model);
  const auto localizer = MakeLocalizer(model, 0);
  localizer->Reset();
  const TimeNs round = acoustics::RoundOf(model.channel, NetworkRun(model.run, model.stations));
  ASSERT_GT(round, 0);
  double fixed_m2 = 0.0;
  for (int t = 0; t <= 100; ++t) {
    OwnReckoning own = flight.Own(t);
    if (t >= 50) {
      own.fix_stamp = 50 * kSecond;
      own.p_WF = flight.True(0, 50.0) + Vec3<double>{1.0, -1.0, 0.0};
      own.fix_std_m = 3.0;
    }
    localizer->Advance(t * kSecond, own);
    if (t == 49) {
      EXPECT_EQ(localizer->fixed(), -1);
    }
    if (t == 50) fixed_m2 = localizer->own().xx;
    if (t == 51) {
      EXPECT_GT(localizer->own().xx, fixed_m2) << "it is not taken again";
    }
    if (t < 50) continue;
    EXPECT_EQ(localizer->fixes(), 1);
    EXPECT_EQ(localizer->fixed(), 50 * kSecond);
    NeighbourState packet;
    packet.generation = t * kSecond;
    localizer->Tell(&packet);
    EXPECT_EQ(packet.has_fix, (t - 50) * kSecond < 3 * round) << t;
    if (!packet.has_fix) continue;
    EXPECT_EQ(packet.fix.stamp, 50 * kSecond);
    EXPECT_NEAR(packet.fix.error_x, -0.3 * 50.0 - 1.0, 1e-9);
    EXPECT_NEAR(packet.fix.error_y, 0.1 * 50.0 + 1.0, 1e-9);
  }
  EXPECT_LT(fixed_m2, 9.0);
}

TEST(RangeLocalizer, APacketTellsOfAStationAndOfAnAuv) {
  const AgentModel model = Model(4, true);
  const Flight flight(model);
  const auto localizer = MakeLocalizer(model, 0);
  localizer->Reset();
  for (int t = 0; t <= 60; ++t) {
    std::vector<Letter> letters;
    if (t > 0) letters.push_back(flight.At(t));
    Advance(flight, t, letters, localizer.get());
  }
  NeighbourState packet;
  packet.generation = 60 * kSecond;
  localizer->Tell(&packet);
  ASSERT_EQ(packet.ranges.size(), 2);
  EXPECT_EQ(packet.ranges[0].source, 4);
  EXPECT_LT(packet.ranges[1].source, 4);
  EXPECT_TRUE(packet.adrift);
  const double then = static_cast<double>(packet.ranges[0].stamp) * 1e-9;
  EXPECT_NEAR(packet.ranges[0].range_m, Norm(flight.True(4, then) - flight.True(0, then)), 0.1);
}

/// Answer of the craft, member 2, to a ping of AUV 0. The AUV is level and points to the east.
acoustics::Reception Answer(const Flight& flight, int t, bool has_direction) {
  const double then = t - 0.5;
  const Vec3<double> way = flight.True(2, then) - flight.True(0, then);
  acoustics::Reception r;
  r.source = 2;
  r.generation = (t - 1) * kSecond + kSecond / 2;
  r.transmit = r.generation - kSecond / 5;
  r.arrival = r.generation + kSecond / 5;
  r.travel_time_s = Norm(way) / kSound_mps;
  r.has_direction = has_direction;
  r.azimuth_rad = std::atan2(way.y, way.x);
  r.elevation_rad = std::atan2(way.z, std::hypot(way.x, way.y));
  return r;
}

// A range and a direction are a full fix: ranges to one craft, in twenty seconds, tell little
// across the line of sight.
TEST(RangeLocalizer, TheDirectionOfAnAnswerTellsWhatItsRangeDoesNot) {
  AgentModel model = Model(2, true);
  model.localization.by = RangesBy::kPing;
  model.localization.usbl_std_deg = 1.0;
  const Flight flight(model);
  double across[2] = {};
  for (const bool has_direction : {false, true}) {
    const auto localizer = MakeLocalizer(model, 0);
    localizer->Reset();
    for (int t = 0; t <= 300; ++t) {
      std::vector<Letter> letters;
      if (t > 0) letters.push_back(flight.At(t));
      if (t > 280) localizer->HearAnswer(Answer(flight, t, has_direction));
      Advance(flight, t, letters, localizer.get());
    }
    const PlaneError e = localizer->own();
    const Vec3<double> way = flight.True(2, 300.0) - flight.True(0, 300.0);
    const double range = std::hypot(way.x, way.y), x = -way.y / range, y = way.x / range;
    across[has_direction] = std::sqrt(x * x * e.xx + 2.0 * x * y * e.xy + y * y * e.yy);
    if (!has_direction) continue;
    EXPECT_NEAR(e.x * x + e.y * y, -0.3 * 300.0 * x + 0.1 * 300.0 * y, 3.0 * across[1]);
    // Twenty directions with an error of 1 deg and one common heading.
    EXPECT_GT(across[1], 0.5 * range * 1.0 * kPi / 180.0 / std::sqrt(20.0));
    EXPECT_LT(across[1], 0.02 * range);
  }
  EXPECT_GT(across[0], 3.0 * across[1]);
}

TEST(RangeLocalizer, IsNotThereByDefault) {
  AgentScenario s;
  EXPECT_EQ(MakeLocalizer(s.model(), 0), nullptr);
}

}  // namespace
}  // namespace stg::agent

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "acoustic_channel/access/medium_access.hpp"
#include "auv_common/error.hpp"
#include "scenario/scenario_input.hpp"
#include "stg_env/scenario/scenario.hpp"

/// Keys of channel, agent, task and reward that something else in the scenario makes useless.
namespace stg::scenario_test {
namespace {

/// A shipped scenario with these overrides: the message with which it is refused, or "".
std::string Refusal(const std::string& name, const std::vector<std::string>& keys) {
  try {
    LoadNamedScenario(STG_SCENARIO_FOLDER, name, "nominal", keys);
  } catch (const UserError& e) {
    return e.what();
  }
  return "";
}

struct Case {
  std::string scenario, key;
  std::string owner;                ///< of the key, as the message names it
  std::string choice;               ///< of the scenario, as the message names it
  std::vector<std::string> chosen;  ///< overrides with which the scenario reads the key
};

const Case kCases[] = {
    {"medium",
     "channel.range_m=0.3",
     "propagation model 'range'",
     "'extended' (channel.model)",
     {"channel.model=range"}},
    {"medium",
     "believed.channel.range_m=0.3",
     "propagation model 'range'",
     "'extended' (channel.model)",
     {"channel.model=range"}},
    {"field",
     "channel.range_m=800",
     "propagation model 'range'",
     "'physical' (channel.model)",
     {"mode=truth"}},
    {"medium",
     "mode=truth\nchannel.model=physical",
     "information mode 'acoustic'",
     "'truth' (mode)",
     {}},
    {"medium_release", "channel.access=tdma", "information mode 'acoustic'", "'truth' (mode)", {}},
    {"medium_release",
     "navigation.kind=dead_reckoning",
     "information mode 'acoustic'",
     "'truth' (mode)",
     {}},
    {"medium_release",
     "track.filter=measurements",
     "information mode 'acoustic'",
     "'truth' (mode)",
     {}},
    {"medium", "task.lost_error_m=0.1", "world 'open water'", "'walls' (sea.open)", {}},
    {"medium", "reward.terms.seabed.weight=1", "world 'open water'", "'walls' (sea.open)", {}},
    {"medium", "reward.terms.obstacle.weight=1", "world 'open water'", "'walls' (sea.open)", {}},
    {"medium", "reward.terms.estimate.weight=1", "world 'open water'", "'walls' (sea.open)", {}},
    {"field", "track.gate_sigma=3", "target filter 'kalman'", "'measurements' (track.filter)", {}},
    {"field",
     "track.initial_speed_std_mps=3",
     "target filter 'kalman'",
     "'measurements' (track.filter)",
     {}},
    {"field",
     "track.process_accel_std_mps2=3",
     "target filter 'kalman'",
     "'measurements' (track.filter)",
     {}},
    {"field",
     "track.measurements.shear_std_mps=0.2",
     "observers' errors 'rates'",
     "'steps' (track.measurements.observers)",
     {"track.measurements.observers=rates"}},
    {"medium", "reward.w_band=0.5", "", "", {}},
    {"medium",
     "reward.separation_distance_m=0.03",
     "separation penalty 'on'",
     "'off' (reward.weights.separation)",
     {"reward.weights.separation=0.1"}},
    {"field", "reward.separation_distance_m=30", "", "", {}},
    {"field",
     "channel.physical.water.ph=7.5",
     "absorption 'francois_garrison'",
     "'thorp' (channel.physical.water.absorption)",
     {"channel.physical.water.absorption=francois_garrison"}},
    {"field",
     "channel.physical.water.profile_speeds_mps=[1500,1500,1500,1490]",
     "sound speed 'profile'",
     "'mackenzie' (channel.physical.water.sound_speed)",
     {"channel.physical.water.sound_speed=profile"}},
    {"field",
     "channel.physical.propagation.wave_height_rms_m=0.3",
     "sound paths 'surface'",
     "'direct alone' (channel.physical.propagation.paths)",
     {"channel.physical.propagation.paths=2"}},
    {"field",
     "channel.physical.propagation.bottom_loss_db=0.3",
     "sound paths 'bottom'",
     "'direct alone' (channel.physical.propagation.paths)",
     {"channel.physical.propagation.paths=3"}},
    {"field", "channel.physical.propagation.rician_k=3", "", "", {}},
    {"field",
     "channel.physical.propagation.shadow_db=10",
     "sea 'terrain' or 'obstacles'",
     "none (sea.terrain, sea.spheres, sea.cylinders, sea.open)",
     {"sea.spheres=[[0,0,-50,40]]"}},
    {"field",
     "channel.physical.noise.burst_db=10",
     "noise bursts 'on'",
     "'off' (channel.physical.noise.burst_every_s)",
     {"channel.physical.noise.burst_every_s=10"}},
    {"field",
     "channel.physical.modem.timing_std_s=0.001",
     "ranging 'one_way' or 'ping'",
     "none (localization.kind, localization.ranges.by, sensing.ranging)",
     {"sensing.ranging=ping", "sensing.period_s=30"}},
    {"field",
     "channel.physical.modem.queue_length=4",
     "queue 'fifo'",
     "'newest' (channel.physical.modem.queue)",
     {"channel.access=csma", "channel.physical.modem.queue=fifo"}},
    {"deep",
     "channel.physical.modem.late_max_s=0.2",
     "late arrivals 'on'",
     "'off' (channel.physical.modem.late_probability)",
     {"channel.physical.modem.late_probability=0.1"}},
    {"medium",
     "observation.tracking=false\nobservation.lost_scale_steps=9",
     "tracking numbers 'true'",
     "'false' (observation.tracking)",
     {}},
};

/// Splits the lines of a case into overrides.
std::vector<std::string> Overrides(const Case& c) {
  std::vector<std::string> keys = c.chosen;
  for (std::size_t begin = 0; begin <= c.key.size();) {
    const std::size_t end = std::min(c.key.find('\n', begin), c.key.size());
    keys.push_back(c.key.substr(begin, end - begin));
    begin = end + 1;
  }
  return keys;
}

TEST(AgentKeys, AKeyThatNothingReadsIsRefusedWithTheChoice) {
  for (const Case& c : kCases) {
    if (c.owner.empty()) {
      EXPECT_EQ(Refusal(c.scenario, {c.key}), "") << c.key;
      continue;
    }
    Case alone = c;
    alone.chosen = {};
    const std::string message = Refusal(c.scenario, Overrides(alone));
    EXPECT_NE(message.find("belongs to the " + c.owner + "; this configuration chose " + c.choice),
              std::string::npos)
        << c.key << ": " << message;
    if (c.chosen.empty()) continue;
    EXPECT_EQ(Refusal(c.scenario, Overrides(c)), "") << c.key;
  }
}

TEST(AgentKeys, WhatAnotherRewardReadsIsRefusedWithReleaseRaw) {
  for (const char* key : {"w_band", "w_progress", "w_closing", "w_reacquire", "w_too_close"}) {
    const std::string text = std::string("reward.") + key + "=0.4";
    EXPECT_EQ(Refusal("medium", {"reward.kind=release", text}), "");
    EXPECT_NE(Refusal("medium", {"reward.kind=release_raw", text})
                  .find("belongs to the reward 'paper' or 'release'; this configuration chose "
                        "'release_raw' (reward.kind)"),
              std::string::npos)
        << key;
  }
}

/// Each formula alone needs the temperature.
TEST(AgentKeys, TheTemperatureIsReadByEitherFormula) {
  const std::string water = "channel.physical.water.";
  const std::string warm = water + "temperature_c=20", profile = water + "sound_speed=profile";
  EXPECT_EQ(Refusal("field", {warm}), "");
  EXPECT_EQ(Refusal("field", {profile, water + "absorption=francois_garrison", warm}), "");
  EXPECT_NE(Refusal("field", {profile, warm})
                .find("'mackenzie' or 'francois_garrison'; this configuration chose 'profile' and "
                      "'thorp' (channel.physical.water.sound_speed, "
                      "channel.physical.water.absorption)"),
            std::string::npos);
}

/// One key of two that choose is enough to pass over a key of the base.
TEST_F(ScenarioInput, EitherOfTwoChoicesPassesOverAKeyOfTheBase) {
  const std::string base =
      Write("base.yaml",
            "base: field.yaml\nchannel:\n  physical:\n    water:\n      sound_speed: profile\n"
            "      absorption: francois_garrison\n      temperature_c: 20.0\n");
  EXPECT_EQ(LoadScenario(base).channel.physical.water.temperature_c, 20.0);
  LoadScenario(base, {}, {"channel.physical.water.absorption=thorp"});
}

/// The time between turns of a medium access comes from its own keys only.
TEST(AgentKeys, OnlyAnAccessWithTurnsHasARound) {
  acoustics::ChannelConfig c;
  c.slots.length_s = 2.0;
  c.periodic.transmit_period_s = 30.0;
  const std::pair<const char*, double> rounds[] = {
      {"tdma", 8.0}, {"slotted_aloha", 8.0}, {"periodic", 30.0}, {"csma", 0.0}, {"aloha", 0.0}};
  for (const auto& [access, round_s] : rounds) {
    c.access = access;
    EXPECT_EQ(acoustics::RoundOfKeys(c, 4), round_s) << access;
    EXPECT_EQ(acoustics::SlotOfKeys(c), round_s == 8.0 ? 2.0 : 0.0) << access;
  }
}

}  // namespace
}  // namespace stg::scenario_test

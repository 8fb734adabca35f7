#include "acoustic_channel/fleet/fleet_channel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>

#include "acoustic_channel/fleet/fleet_config.hpp"
#include "auv_common/error.hpp"
#include "scratch_file.hpp"

namespace stg::acoustics {
namespace {

constexpr TimeNs kFleetMs = 1'000'000;
constexpr TimeNs kEpoch = 1'700'000'000'000'000'000;  // a time of a wall clock

/// Writes down everything that it hears.
struct Scribe : FleetListener {
  std::vector<std::string> lines;
  TimeNs start = -1;
  int heard = 0;

  template <class... Args>
  void Note(const Args&... args) {
    std::ostringstream line;
    line.precision(17);
    ((line << args << ' '), ...);
    lines.push_back(line.str());
  }
  void OnBegin(TimeNs t) override { start = t; }
  void OnReceptions(int vehicle, const std::vector<Reception>& received) override {
    for (const Reception& r : received) {
      Note("heard", vehicle, r.source, r.tag, r.transmit, r.arrival, r.distance_m, r.doppler_mps,
           std::string(r.payload.data, r.payload.data + r.payload.size));
      ++heard;
    }
  }
  void OnAbsent(const Transmission& p) override { Note("absent", p.source, p.tag); }
  void OnPingRefused(std::uint32_t tag, const std::string& why) override {
    Note("no ping", tag, why);
  }
  void OnDiscarded(const PacketInfo& p, DropReason reason, TimeNs t) override {
    Note("discarded", p.source, p.tag, ToString(reason), t);
  }
  void OnFate(const PacketInfo& p, const PacketFate& f) override {
    Note("fate", p.source, p.tag, p.bytes, f.receiver, ToString(f.reason), f.arrival, f.distance_m);
  }
  bool Has(const std::string& text) const {
    return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
      return line.find(text) != std::string::npos;
    });
  }
};

/// Three vehicles on links that lose about every fifth packet.
NetworkConfig FleetNetwork(double loss = 0.2) {
  NetworkConfig n;
  n.run.agents = 3;
  n.run.seed = 7;
  n.channel.model = "extended";
  n.channel.periodic.transmit_period_s = 0.1;
  n.channel.extended.max_range_m = 2000.0;
  n.channel.extended.loss_probability = loss;
  n.channel.extended.loss_distance_m = 1e9;
  return n;
}

Transmission Saying(int source, std::uint32_t tag, TimeNs stamp, const std::string& text) {
  Transmission t;
  t.source = source;
  t.tag = tag;
  t.stamp = t.generation = stamp;
  t.payload = {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  return t;
}

/// Vehicle i is 100 i metres from the origin and moves north at i m/s.
Motion Cruise(int i, TimeNs t) {
  const double speed = i;
  return {{100.0 * i, speed * Seconds(t - kEpoch), 0.0}, {0.0, speed, 0.0}};
}

/// A call of the channel, and the time of the clock at the call.
struct Spoken {
  TimeNs clock;
  std::function<void(FleetChannel*)> say;
};

/// Calls for 20 s of packets, and of odometry at 10 Hz with jitter.
std::vector<Spoken> Traffic() {
  std::vector<Spoken> words;
  std::mt19937 draw(3);
  for (int i = 0; i < 3; ++i) {
    for (TimeNs ms = 0; ms < 20'000; ms += 100) {
      const TimeNs t = kEpoch + (ms + static_cast<TimeNs>(draw() % 60)) * kFleetMs;
      words.push_back({t, [i, t](FleetChannel* c) { c->Move(i, t, Cruise(i, t)); }});
    }
    for (TimeNs ms = 300 + 17 * i; ms < 20'000; ms += 330) {
      const TimeNs t = kEpoch + ms * kFleetMs;
      words.push_back(
          {t, [i, t, ms](FleetChannel* c) {
             c->Offer(Saying(i, static_cast<std::uint32_t>(ms), t, "ahoy " + std::to_string(ms)));
           }});
    }
  }
  return words;
}

/// Makes the calls in order of the clock. The channel runs up to each of them first.
void Play(std::vector<Spoken> words, FleetChannel* channel) {
  std::stable_sort(words.begin(), words.end(),
                   [](const Spoken& a, const Spoken& b) { return a.clock < b.clock; });
  for (const Spoken& word : words) {
    channel->Run(word.clock);
    word.say(channel);
  }
  channel->Finish();
}

/// Modems that listen before they send, and that collide all the same.
NetworkConfig PhysicalNetwork() {
  NetworkConfig n = FleetNetwork();
  n.channel.model = "physical";
  n.channel.access = "csma";
  return n;
}

/// Fails with the first line that differs.
void ExpectSame(const std::vector<std::string>& lines, const std::vector<std::string>& wanted) {
  const auto [a, b] = std::mismatch(lines.begin(), lines.end(), wanted.begin(), wanted.end());
  EXPECT_TRUE(a == lines.end() && b == wanted.end())
      << (a == lines.end() ? "nothing" : *a) << "\ninstead of\n"
      << (b == wanted.end() ? "nothing" : *b) << "\nin line " << b - wanted.begin();
}

void ExpectFunctionOfTheStamps(const NetworkConfig& network, int least) {
  Scribe first;
  FleetChannel channel(network, {}, &first);
  Play(Traffic(), &channel);
  ASSERT_GT(first.heard, least);

  // Every call comes up to 90 ms late, and so the channel runs up to other times.
  std::vector<Spoken> late = Traffic();
  std::mt19937 draw(11);
  for (Spoken& word : late) word.clock += static_cast<TimeNs>(draw() % 90) * kFleetMs;
  Scribe second;
  FleetChannel other(network, {}, &second);
  Play(late, &other);
  ExpectSame(second.lines, first.lines);

  // After a restart it repeats itself.
  second.lines.clear();
  other.Restart();
  Play(Traffic(), &other);
  ExpectSame(second.lines, first.lines);
}

TEST(FleetChannel, WhatComesOutIsAFunctionOfTheStamps) {
  ExpectFunctionOfTheStamps(FleetNetwork(), 200);
}

TEST(FleetChannel, SoItIsWhereModemsDisturbEachOther) {
  ExpectFunctionOfTheStamps(PhysicalNetwork(), 40);
}

TEST(FleetChannel, ModemsSendWhenTheyWereAskedToAndNotAtTheNextStep) {
  NetworkConfig network = PhysicalNetwork();
  network.channel.access = "aloha";
  Scribe scribe;
  FleetChannel channel(network, {}, &scribe);
  for (int k = 0; k < 50; ++k) {
    const TimeNs t = kEpoch + 100 * k * kFleetMs;
    for (int i = 0; i < 2; ++i) channel.Move(i, t, Cruise(i, t));
  }
  const TimeNs stamp = kEpoch + 1'234'567'890;
  channel.Offer(Saying(0, 5, stamp, "now"));
  channel.Finish();
  ASSERT_EQ(scribe.heard, 1);
  EXPECT_TRUE(scribe.Has("heard 1 0 5 " + std::to_string(stamp - scribe.start)));
}

TEST(FleetChannel, DistanceAndDopplerAreThoseOfTheMotionAtTransmission) {
  Scribe scribe;
  FleetChannel channel(FleetNetwork(0.0), {}, &scribe);
  Play(Traffic(), &channel);
  int found = 0;
  for (const std::string& line : scribe.lines) {
    std::istringstream in(line);
    std::string kind;
    int receiver = 0, source = 0;
    TimeNs tag = 0, transmit = 0, arrival = 0;
    double distance = 0.0, doppler = 0.0;
    in >> kind;
    if (kind != "heard") continue;
    in >> receiver >> source >> tag >> transmit >> arrival >> distance >> doppler;
    const TimeNs t = scribe.start + transmit;
    const Vec3<double> r = Cruise(receiver, t).p_W - Cruise(source, t).p_W;
    EXPECT_NEAR(distance, Norm(r), 1e-6);
    EXPECT_NEAR(doppler, -(receiver - source) * r.y / Norm(r), 1e-6);
    EXPECT_NEAR(Seconds(arrival - transmit), Norm(r) / 1500.0, 1e-8);
    ++found;
  }
  EXPECT_GT(found, 300);
}

TEST(FleetChannel, WhoIsSilentOrNotThereYetNeitherSendsNorHears) {
  Scribe scribe;
  FleetChannel channel(FleetNetwork(0.0), {}, &scribe);
  const auto at = [](double s) { return kEpoch + static_cast<TimeNs>(s * 1e9); };
  for (int k = 0; k < 200; ++k) {
    const double s = 0.1 * k;
    channel.Move(0, at(s), Cruise(0, at(s)));
    if (s < 5.0 || s >= 15.0) channel.Move(1, at(s), Cruise(1, at(s)));
    if (s >= 10.0) channel.Move(2, at(s), Cruise(2, at(s)));
    if (k % 10 == 0) channel.Offer(Saying(0, static_cast<std::uint32_t>(k), at(s), "all"));
    if (k == 90) channel.Offer(Saying(1, 1000, at(s), "from nowhere"));
    channel.Run(at(s));
  }
  channel.Finish();
  EXPECT_TRUE(scribe.Has("absent 1 1000"));
  EXPECT_TRUE(scribe.Has("heard 1 0 40 "));
  EXPECT_TRUE(scribe.Has("heard 1 0 70 ")) << "three seconds after its last word";
  EXPECT_FALSE(scribe.Has("heard 1 0 90 "));
  EXPECT_TRUE(scribe.Has("heard 1 0 160 ")) << "it is back";
  EXPECT_FALSE(scribe.Has("heard 2 0 90 "));
  EXPECT_TRUE(scribe.Has("heard 2 0 110 ")) << "it has joined";
}

TEST(FleetChannel, WaitsForAVehicleThatIsThereNoLongerThanItsPatience) {
  Scribe scribe;
  FleetChannel channel(FleetNetwork(0.0), {0.1, 1.0, 3.0, true}, &scribe);
  for (int i = 0; i < 2; ++i) channel.Move(i, kEpoch, Cruise(i, kEpoch));
  channel.Move(0, kEpoch + 10'000 * kFleetMs, Cruise(0, kEpoch));
  channel.Run(kEpoch + 900 * kFleetMs);
  EXPECT_EQ(channel.closed(), kEpoch) << "vehicle 1 may still speak of what was";
  channel.Run(kEpoch + 2000 * kFleetMs);
  EXPECT_EQ(channel.closed(), kEpoch + 900 * kFleetMs) << "patience and lag behind the clock";
  channel.Run(kEpoch + 6000 * kFleetMs);
  channel.Run(kEpoch + 6000 * kFleetMs);
  EXPECT_EQ(channel.closed(), kEpoch + 5900 * kFleetMs) << "no vehicle waits for the silent one";
}

TEST(FleetChannel, APacketThatNoModemTakesIsRefusedAndTheRestGoesOn) {
  Scribe scribe;
  FleetChannel channel(FleetNetwork(0.0), {}, &scribe);
  const std::string endless(100'000, 'x');
  EXPECT_THROW(channel.Offer(Saying(0, 1, kEpoch, endless)), UserError);
  EXPECT_THROW(channel.Offer(Saying(0, 2, kEpoch, "")), UserError);
  EXPECT_THROW(channel.Offer(Saying(3, 3, kEpoch, "where?")), UserError);
  Transmission lost = Saying(0, 4, kEpoch, "where?");
  lost.destination = 3;
  EXPECT_THROW(channel.Offer(lost), UserError);
  Transmission prophecy = Saying(0, 5, kEpoch, "soon");
  prophecy.generation += 1;
  EXPECT_THROW(channel.Offer(prophecy), UserError);
  channel.Ping(0, 1, 1'000'000'000, 6);
  Play(Traffic(), &channel);
  EXPECT_GT(scribe.heard, 300);
  EXPECT_TRUE(scribe.Has("no ping 6")) << "extended has no ranging";
}

TEST(FleetConfig, TheSectionChannelIsEnoughAndTyposAreNamed) {
  const auto load = [](const std::string& text, const std::vector<std::string>& overrides = {}) {
    return LoadFleetNetwork(ScratchFile(text).path(), overrides, 5);
  };
  const NetworkConfig n = load("seed: 3\nchannel: {model: range, range_m: 120.0}\n");
  EXPECT_EQ(n.run.agents, 5);
  EXPECT_EQ(n.run.seed, 3u);
  EXPECT_EQ(n.channel.model, "range");
  EXPECT_EQ(n.channel.range_m, 120.0);
  EXPECT_EQ(n.channel.extended.freshness_s, ChannelConfig().extended.freshness_s);
  EXPECT_EQ(load("channel: {model: range}", {"channel.range_m=7"}).channel.range_m, 7.0);
  const auto error = [&](const std::string& text) -> std::string {
    try {
      load(text);
    } catch (const UserError& e) {
      return e.what();
    }
    return "none";
  };
  EXPECT_NE(error("channel: {model: range, rang_m: 1.0}").find("did you mean channel.range_m"),
            std::string::npos);
  EXPECT_NE(error("chanel: {model: range}").find("channel.model"), std::string::npos);
  EXPECT_NE(error("channel: {model: telepathy}").find("telepathy"), std::string::npos);
  EXPECT_NE(error("channel: {model: range, extended: {loss_probability: 1.0}}")
                .find("belongs to the propagation model 'extended'; this configuration chose"),
            std::string::npos);
  EXPECT_NE(error("channel: {model: range}\nsensing: {range_m: 1.0}").find("sensing"),
            std::string::npos);
  // A file may be a whole scenario, but an override is for the network.
  const std::string scenario = "name: mine\nchannel: {model: range}\nsensing: {range_m: 1.0}\n";
  EXPECT_EQ(load(scenario, {"channel.range_m=7", "seed=2"}).run.seed, 2u);
  EXPECT_THROW(load(scenario, {"sensing.range_m=2"}), UserError);
  EXPECT_THROW(load(scenario, {"chanel.range_m=2"}), UserError);
  EXPECT_THROW(load(scenario, {"time.tail_steps=2"}), UserError);
}

TEST(FleetChannel, WithoutModemsTheNewestPacketOfAStepLeavesAndTheOthersAreTold) {
  Scribe scribe;
  FleetChannel fleet(FleetNetwork(0.0), FleetPatience(), &scribe);
  for (int step = 0; step <= 10; ++step) {
    const TimeNs t = kEpoch + step * 100 * kFleetMs;
    for (int i = 0; i < 3; ++i) fleet.Move(i, t, {{10.0 * i, 0.0, -5.0}, {}});
    for (std::uint32_t k = 0; k < 5; ++k) {
      fleet.Offer(Saying(0, 10U * static_cast<std::uint32_t>(step) + k, t - k * kFleetMs, "x"));
    }
  }
  fleet.Finish();
  int discarded = 0;
  for (const std::string& line : scribe.lines) discarded += line.rfind("discarded 0", 0) == 0;
  EXPECT_EQ(discarded, 11 * 4);
  EXPECT_TRUE(scribe.Has("heard 1 0 50 ")) << "the newest of step 5, in step 5";
  EXPECT_FALSE(scribe.Has("heard 1 0 51 "));
}

TEST(FleetChannel, PacketsOfTheFutureWaitInALimitedNumber) {
  Scribe scribe;
  FleetChannel fleet(FleetNetwork(), FleetPatience(), &scribe);
  fleet.Move(0, kEpoch, {});
  int taken = 0;
  EXPECT_THROW(
      {
        for (std::uint32_t k = 0; k < 1'000'000; ++k, ++taken) {
          fleet.Offer(Saying(0, k, kEpoch + 1'000'000'000, "x"));
        }
      },
      UserError);
  EXPECT_EQ(taken, 10'000);
}

}  // namespace
}  // namespace stg::acoustics

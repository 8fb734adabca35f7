#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/emulator/modem_water.hpp"
#include "acoustic_channel/janus/janus_modem.hpp"
#include "acoustic_channel/micromodem/micromodem.hpp"
#include "acoustic_channel/s2c/s2c_modem.hpp"
#include "network/network_fixture.hpp"

namespace stg::acoustics {

/// Everything that the hosts of the modems saw, with the times.
struct Hosts : ModemHosts {
  struct Said {
    int node;
    double t_s;
    std::string bytes;
  };
  void Write(int node, const std::string& bytes) override {
    said.push_back({node, Seconds(water->now()), bytes});
    all[node] += bytes;
  }
  void HangUp(int node) override { hung_up.push_back(node); }
  void OnSharedAddress(int node, int) override { shared.push_back(node); }

  ModemWater* water = nullptr;
  std::vector<Said> said;
  std::map<int, std::string> all;
  std::vector<int> hung_up, shared;
};

/// Modems in water that the test sets. Every link is 1500 m long, has 1500 m/s and loses nothing,
/// unless a test sets something else.
struct ModemBench {
  explicit ModemBench(int nodes) {
    run.agents = nodes;
    config.model = "physical";
    config.access = "aloha";
    config.physical.modem.queue = QueuePolicy::kFifo;
    config.physical.modem.profile = "evologics_s2c";
    auto stated = std::make_unique<StatedMedium>(nodes);
    medium = stated.get();
    for (int i = 0; i < nodes; ++i) {
      for (int j = 0; j < i; ++j) medium->SetDelay(i, j, 1.0);
    }
    stated_ = std::move(stated);
  }
  /// Gives every node an S2C modem with a NET interpreter. Addresses begin with 1.
  ModemWater& StartS2c(s2c::ModemOptions options = NetOptions()) {
    Make();
    for (int i = 0; i < run.agents; ++i) {
      options.address = i + 1;
      water->Attach(i, options.address, [&](ModemSurroundings* world) {
        auto modem = std::make_unique<s2c::S2cModem>(options, world);
        modems.push_back(modem.get());
        return modem;
      });
    }
    return Begin();
  }
  /// Gives every node a Micromodem. Addresses begin with 1. The modems have booted at 2.5 s.
  ModemWater& StartMicromodems(const std::string& firmware = "2.0.35490") {
    config.physical.modem.profile = "micromodem_psk_r1";
    Make();
    for (int i = 0; i < run.agents; ++i) {
      water->Attach(i, i + 1, [&](ModemSurroundings* world) {
        micromodem::ModemOptions options;
        options.address = i + 1;
        options.firmware = firmware;
        options.pps = pps;
        auto modem = std::make_unique<micromodem::Micromodem>(options, world);
        micromodems.push_back(modem.get());
        return modem;
      });
    }
    water->SetUtcStart(kUtcStart);
    Begin();
    water->Advance(Ns(2.5));
    hosts.all.clear();
    hosts.said.clear();
    return *water;
  }
  /// Gives every node a JANUS modem. Stations begin with 1.
  ModemWater& StartJanus() {
    config.physical.modem.profile = "janus";
    Make();
    for (int i = 0; i < run.agents; ++i) {
      water->Attach(i, i + 1, [&](ModemSurroundings* world) {
        janus::ModemOptions options;
        options.station = i + 1;
        return std::make_unique<janus::JanusModem>(options, world);
      });
    }
    return Begin();
  }
  static constexpr TimeNs kUtcStart = 1'700'000'000 * kSecond;  ///< 2023-11-14, 22:13:20
  void Make() {
    water = std::make_unique<ModemWater>(config, run, std::move(stated_), &hosts);
    hosts.water = water.get();
  }
  /// @param hosts_count so many first nodes have a host; -1: all nodes
  ModemWater& Begin(int hosts_count = -1) {
    water->Observe(&log);
    water->Reset(1, 0);
    const int count = hosts_count < 0 ? run.agents : hosts_count;
    for (int i = 0; i < count; ++i) water->Connect(i, 0);
    return *water;
  }
  static s2c::ModemOptions NetOptions() {
    s2c::ModemOptions options;
    options.net = true;
    return options;
  }
  void Say(int node, double t_s, const std::string& text) const {
    water->Read(node, Ns(t_s), {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  /// What the host gets as an immediate answer.
  std::string Ask(int node, double t_s, const std::string& text) {
    water->Advance(Ns(t_s));
    const std::size_t before = hosts.all[node].size();
    Say(node, t_s, text);
    return hosts.all[node].substr(before);
  }
  /// The time at which a host got this. The test fails unless it came exactly once.
  double When(int node, const std::string& bytes) const {
    double t_s = -1.0;
    int times = 0;
    for (const Hosts::Said& s : hosts.said) {
      if (s.node != node || s.bytes != bytes) continue;
      t_s = s.t_s;
      ++times;
    }
    EXPECT_EQ(times, 1) << bytes;
    return t_s;
  }

  RunConfig run;
  ChannelConfig config;
  bool pps = false;  ///< a line with ticks is connected to the Micromodems
  StatedMedium* medium;
  Hosts hosts;
  std::unique_ptr<ModemWater> water;
  std::vector<s2c::S2cModem*> modems;
  std::vector<micromodem::Micromodem*> micromodems;
  Log log;

 private:
  std::unique_ptr<Medium> stated_;
};

}  // namespace stg::acoustics

#include <gtest/gtest.h>

#include <string>

#include "acoustic_channel/driver/modem_channel.hpp"
#include "acoustic_channel/emulator/modem_server.hpp"
#include "auv_common/error.hpp"
#include "scratch_file.hpp"

/// A modem with a port is a node of the simulated water, and modems with ports are the channel of a
/// swarm. The modems here are emulated ones, each in its own tank.
namespace stg::acoustics {
namespace {

constexpr TimeNs kTick = 2'000'000;

ModemFile WaterWith(const std::string& first, const std::string& second) {
  const ScratchFile file("vehicles:\n  - {name: a, position_m: [0.0, 0.0, -20.0], " + first +
                         "}\n  - {name: b, position_m: [15.0, 0.0, -20.0], " + second +
                         "}\nchannel:\n  model: physical\n  access: aloha\n  physical:\n"
                         "    modem:\n      profile: evologics_s2c\n      queue: fifo\n");
  return LoadModemFile(file.path());
}

constexpr char kModem[] = "modem: {tcp: 0, interpreter: net}";

std::string AddressOf(const BytePort& port) {
  return "tcp://127.0.0.1:" + port.name().substr(port.name().rfind(':') + 1);
}

ModemPort HostOf(const BytePort& port, int address) {
  DriverOptions options;
  options.address = address;
  return ModemPort("s2c", options, AddressOf(port), 19200);
}

TEST(Gateway, WhatOneSideHearsTheOtherSends) {
  ModemServer tank(WaterWith(kModem, kModem), "");
  ModemServer water(WaterWith(kModem, "gateway: {port: " + AddressOf(*tank.port(0)) + "}"), "");
  ModemPort in_water = HostOf(*water.port(0), 1), in_tank = HostOf(*tank.port(1), 2);
  const auto serve = [&](double seconds) {
    const TimeNs end = SteadyNow() + static_cast<TimeNs>(seconds * 1e9);
    while (SteadyNow() < end) {
      tank.Serve(tank.Now());
      water.Serve(water.Now());
      ModemPort::Serve({&in_water, &in_tank}, SteadyNow() + kTick);
    }
  };
  for (int k = 0; k < 50 && !(in_water.driver().ready() && in_tank.driver().ready() &&
                              water.gateway(1)->driver().ready());
       ++k) {
    serve(0.1);
  }
  ASSERT_TRUE(water.gateway(1)->driver().ready());
  in_water.driver().Send({1, kToAll, "out of the water"}, SteadyNow());
  serve(1.5);
  const auto heard = in_tank.TakeReceptions();
  ASSERT_EQ(heard.size(), 1u);
  EXPECT_EQ(heard[0].payload, "out of the water");
  in_tank.driver().Send({2, kToAll, "into the water"}, SteadyNow());
  serve(1.5);
  const auto answered = in_water.TakeReceptions();
  ASSERT_EQ(answered.size(), 1u);
  EXPECT_EQ(answered[0].payload, "into the water");
}

TEST(Gateway, ItNeedsAPortAndStandsAlone) {
  EXPECT_THROW(WaterWith(kModem, "gateway: {baud: 19200}"), UserError);
  EXPECT_THROW(WaterWith(kModem, "gateway: {port: 'tcp://127.0.0.1:9', baud: 19200}"), UserError);
  EXPECT_THROW(WaterWith(kModem, std::string(kModem) + ", gateway: {port: /dev/null}"), UserError);
}

TEST(ModemChannel, AStepsPacketIsHeardInALaterStep) {
  ModemServer tank(WaterWith(kModem, kModem), "");
  ChannelConfig config;
  config.model = "physical";
  config.access = "aloha";
  config.contention.rest_s = 0.0;
  config.physical.modem.profile = "evologics_s2c";
  RunConfig run;
  run.agents = 2;
  ModemChannelConfig modems;
  modems.ports = {AddressOf(*tank.port(0))};
  EXPECT_THROW(ModemChannel(config, run, modems), UserError);  // there is one modem for two agents
  modems.ports.push_back(AddressOf(*tank.port(1)));
  ModemChannel channel(config, run, modems);
  channel.Reset(1, 0);
  const auto serve = [&](double seconds) {
    const TimeNs end = SteadyNow() + static_cast<TimeNs>(seconds * 1e9);
    while (SteadyNow() < end) tank.Serve(tank.Now() + kTick);
  };
  for (int k = 0; k < 50 && !(channel.health(0).ready && channel.health(1).ready); ++k) serve(0.1);
  ASSERT_TRUE(channel.health(0).ready);
  const std::vector<Vec3<double>> nowhere(2);
  const std::string text = "hello";
  Transmission packet;
  packet.payload = {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  channel.Step(0, 0, nowhere, nowhere, {packet});
  serve(1.0);
  constexpr TimeNs kStep = 1'000'000'000;
  channel.Step(kStep, 1, nowhere, nowhere, {});
  std::vector<Reception> received;
  channel.Deliver(1, 2 * kStep, &received);
  ASSERT_EQ(received.size(), 1u);
  EXPECT_EQ(received[0].source, 0);
  EXPECT_EQ(std::string(received[0].payload.data, received[0].payload.data + 5), text);
  // It left at 0, took .2065 s and 10 ms in the water, and arrived before the step began.
  EXPECT_GT(received[0].arrival, 200'000'000);
  EXPECT_LE(received[0].arrival, kStep);
  EXPECT_EQ(channel.totals().delivered, 1u);
  received.clear();
  channel.Deliver(0, 2 * kStep, &received);
  EXPECT_TRUE(received.empty());
}

}  // namespace
}  // namespace stg::acoustics

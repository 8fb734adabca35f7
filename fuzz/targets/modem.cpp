#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "acoustic_channel/driver/modem_driver.hpp"
#include "acoustic_channel/emulator/modem_water.hpp"
#include "acoustic_channel/janus/janus_modem.hpp"
#include "acoustic_channel/micromodem/lbl.hpp"
#include "acoustic_channel/micromodem/micromodem.hpp"
#include "acoustic_channel/s2c/s2c_modem.hpp"
#include "target.hpp"

/// Messages of hosts to emulated modems, and of modems to drivers.
namespace stg::fuzz {
namespace {

using acoustics::ModemEngine;
using acoustics::ModemSurroundings;
using acoustics::ModemWater;

constexpr TimeNs kStart = 3'000'000'000;
constexpr std::size_t kMostSaid = 64 << 20;

/// Records whether a modem sent anything except errors.
struct Listeners : acoustics::ModemHosts {
  void Write(int /*node*/, const std::string& bytes) override {
    said += bytes.size();
    Require(said < kMostSaid, "a modem that does not stop talking");
    const bool error = bytes.find("ERR") != std::string::npos || bytes.rfind("error ", 0) == 0;
    sound = sound || !error;
  }
  void HangUp(int /*node*/) override {}
  std::size_t said = 0;
  bool sound = false;
};

/// Modems in a row, 1500 m apart. The bytes go to the first one: a line every 50 ms, and at most
/// seven bytes at once, so that splits are tested, too. All actions that they start must end.
bool Talk(const std::string& bytes, const char* profile,
          const std::vector<ModemWater::MakeEngine>& modems) {
  RunConfig run;
  run.agents = static_cast<int>(modems.size());
  acoustics::ChannelConfig config;
  config.model = "physical";
  config.access = "aloha";
  config.physical.modem.queue = acoustics::QueuePolicy::kFifo;
  config.physical.modem.profile = profile;
  Listeners hosts;
  ModemWater water(config, run, &hosts);
  for (int i = 0; i < run.agents; ++i) {
    water.Attach(i, i + 1, modems[static_cast<std::size_t>(i)]);
  }
  water.Reset(1, 0);
  for (int i = 0; i < run.agents; ++i) {
    water.Move(i, 0, {{1500.0 * i, 0.0, -20.0}, {0.0, 0.0, 0.0}});
    water.Connect(i, 0);
  }
  TimeNs t = kStart;
  water.Advance(t);
  hosts.sound = false;
  std::size_t size = 1;
  for (std::size_t at = 0; at < bytes.size(); at += size) {
    size = std::min<std::size_t>(1 + at % 7, bytes.size() - at);
    water.Read(0, t, {reinterpret_cast<const std::uint8_t*>(bytes.data()) + at, size});
    if (bytes.substr(at, size).find('\n') != std::string::npos) t += 50'000'000;
  }
  const bool sound = hosts.sound;
  water.Advance(t + 100'000'000'000);
  return sound;
}

struct NoWorld : acoustics::DriverWorld {
  void Write(const std::string& bytes) override { said += bytes.size(); }
  void HangUp() override {}
  void OnReception(const acoustics::DriverReception& reception) override {
    heard = true;
    Require(reception.payload.size() <= 2048, "a payload that no modem sends");
    for (double number : {reception.airtime_s, reception.received_level_db,
                          reception.noise_level_db, reception.sinr_db, reception.doppler_mps}) {
      Require(std::isfinite(number), "a reception with a number that is not finite");
    }
  }
  void OnSendEnd(std::uint32_t /*tag*/, double airtime_s) override {
    Require(std::isfinite(airtime_s), "an airtime that is not finite");
  }
  void OnRange(int /*address*/, double one_way_s) override {
    Require(std::isfinite(one_way_s), "a range that is not finite");
  }
  std::size_t said = 0;
  bool heard = false;
};

}  // namespace

bool RunS2cModem(const std::string& bytes) {
  const auto make = [](bool net, int address) {
    return [net, address](ModemSurroundings* world) -> std::unique_ptr<ModemEngine> {
      acoustics::s2c::ModemOptions options;
      options.net = net;
      options.address = address;
      return std::make_unique<acoustics::s2c::S2cModem>(options, world);
    };
  };
  const bool at = Talk(bytes, "evologics_s2c", {make(false, 1), make(true, 2)});
  const bool net = Talk(bytes, "evologics_s2c", {make(true, 1), make(true, 2)});
  return at || net;
}

bool RunJanusModem(const std::string& bytes) {
  const auto make = [](int station) {
    return [station](ModemSurroundings* world) -> std::unique_ptr<ModemEngine> {
      acoustics::janus::ModemOptions options;
      options.station = station;
      return std::make_unique<acoustics::janus::JanusModem>(options, world);
    };
  };
  return Talk(bytes, "janus", {make(1), make(2)});
}

bool RunMicromodem(const std::string& bytes) {
  const auto make = [](int address) {
    return [address](ModemSurroundings* world) -> std::unique_ptr<ModemEngine> {
      acoustics::micromodem::ModemOptions options;
      options.address = address;
      return std::make_unique<acoustics::micromodem::Micromodem>(options, world);
    };
  };
  const auto transponder = [](ModemSurroundings* world) -> std::unique_ptr<ModemEngine> {
    acoustics::micromodem::TransponderOptions options;
    options.slot = 0;
    return std::make_unique<acoustics::micromodem::Transponder>(options, world);
  };
  return Talk(bytes, "micromodem_psk_r1", {make(1), make(2), transponder});
}

bool RunModemAnswers(const std::string& bytes) {
  bool heard = false;
  for (const char* protocol : {"s2c", "micromodem"}) {
    NoWorld world;
    const auto driver = acoustics::MakeModemDriver(protocol, {}, &world);
    TimeNs t = kStart;
    driver->Connect(t);
    std::size_t size = 1;
    for (std::size_t at = 0; at < bytes.size(); at += size) {
      size = std::min<std::size_t>(1 + at % 7, bytes.size() - at);
      driver->Read(t, {reinterpret_cast<const std::uint8_t*>(bytes.data()) + at, size});
      if (at % 32 == 0) driver->Send({1, acoustics::kToAll, "hello"}, t);
      if (at % 96 == 0) driver->Ping(2, t);
      t += 20'000'000;
      driver->Tick(t);
    }
    heard = heard || world.heard;
  }
  return heard;
}

}  // namespace stg::fuzz

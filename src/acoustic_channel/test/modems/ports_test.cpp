#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>
#include <vector>

#include "acoustic_channel/emulator/modem_server.hpp"
#include "auv_common/error.hpp"
#include "scratch_file.hpp"

/// Emulated modems behind sockets and terminals, in real time.
namespace stg::acoustics {
namespace {

ModemFile ModemsWith(const std::string& alpha, const std::string& beta,
                     const std::string& gamma = "") {
  const ScratchFile file(
      "vehicles:\n"
      "  - {name: alpha, position_m: [0.0, 0.0, -20.0], modem: {" +
      alpha + "}}\n  - {name: beta, position_m: [150.0, 0.0, -20.0], modem: {" + beta +
      (gamma.empty() ? "" : "}}\n  - {name: gamma, position_m: [0.0, 150.0, -20.0], modem: {") +
      gamma +
      "}}\nchannel:\n  model: physical\n  access: aloha\n  physical:\n    modem:\n"
      "      profile: evologics_s2c\n      queue: fifo\n");
  return LoadModemFile(file.path());
}

sockaddr_in PlaceOf(const BytePort& port) {
  const int number = std::stoi(port.name().substr(port.name().rfind(':') + 1));
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(static_cast<std::uint16_t>(number));
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return place;
}

/// The client of one port.
struct Client {
  explicit Client(const BytePort& port) {
    const sockaddr_in place = PlaceOf(port);
    stream = socket(AF_INET, SOCK_STREAM, 0);
    EXPECT_EQ(connect(stream, reinterpret_cast<const sockaddr*>(&place), sizeof(place)), 0);
    fcntl(stream, F_SETFL, O_NONBLOCK);
  }
  ~Client() { close(stream); }
  void Say(const std::string& text) const {
    EXPECT_EQ(write(stream, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  /// True if this text is heard within ten seconds.
  bool Hears(ModemServer* server, const std::string& text) {
    const TimeNs end = SteadyNow() + 10'000'000'000;
    while (heard.find(text) == std::string::npos && SteadyNow() < end && !gone) {
      server->Serve(server->Now() + 2'000'000);
      std::array<char, 4096> buffer;
      const ssize_t size = read(stream, buffer.data(), buffer.size());
      if (size > 0) heard.append(buffer.data(), static_cast<std::size_t>(size));
      gone = size == 0;
    }
    return heard.find(text) != std::string::npos;
  }
  int stream = -1;
  std::string heard;
  bool gone = false;
};

const std::string kNet = "protocol: s2c, tcp: 0, interpreter: net";

TEST(ModemPorts, AMessageGoesFromOneSocketToTheOther) {
  ModemServer server(ModemsWith(kNet, kNet), "");
  Client alpha(*server.port(0)), beta(*server.port(1));
  alpha.Say("AT*SENDIM,5,2,ack,hello\n");
  EXPECT_TRUE(beta.Hears(&server, "RECVIM,5,1,2,ack,"));
  EXPECT_TRUE(alpha.Hears(&server, "DELIVEREDIM,2\r\n"));
}

TEST(ModemPorts, OnlyAMicromodemHasATick) {
  try {
    ModemsWith(kNet + ", pps: true", kNet);
    ADD_FAILURE() << "the key was accepted";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("micromodem"), std::string::npos) << error.what();
  }
}

TEST(ModemPorts, ASecondClientIsRefusedAndTheFirstGoesOn) {
  ModemServer server(ModemsWith(kNet, kNet), "");
  Client first(*server.port(0));
  first.Say("AT?AL\n");
  EXPECT_TRUE(first.Hears(&server, "1\r\n"));
  Client second(*server.port(0));
  EXPECT_FALSE(second.Hears(&server, "anything"));
  EXPECT_TRUE(second.gone);
  first.Say("AT?RT\n");
  EXPECT_TRUE(first.Hears(&server, "5000\r\n"));
}

TEST(ModemPorts, OneOfManyClientsIsObeyedAndAllAreTold) {
  ModemServer server(ModemsWith(kNet + ", clients: 2", kNet), "");
  std::vector<std::string> log;
  server.say = [&](const std::string& what) { log.push_back(what); };
  Client first(*server.port(0)), beta(*server.port(1));
  first.Say("AT?AL\n");
  EXPECT_TRUE(first.Hears(&server, "1\r\n"));
  Client second(*server.port(0));
  second.Say("AT!L2\n");
  EXPECT_TRUE(second.Hears(&server, "ERROR NO CONTROL\r\n"));
  Client third(*server.port(0));
  EXPECT_FALSE(third.Hears(&server, "anything"));
  EXPECT_EQ(log.back(), "alpha: another host was refused; this modem accepts no more hosts");

  beta.Say("AT*SENDIM,5,1,noack,hello\n");
  EXPECT_TRUE(first.Hears(&server, "RECVIM,5,2,1,noack,"));
  EXPECT_TRUE(second.Hears(&server, "RECVIM,5,2,1,noack,"));
  EXPECT_EQ(second.heard.find("1\r\n"), std::string::npos) << "an answer to another host";

  // The modem must answer what comes after the command that takes control.
  second.Say("AT@CTRL\nAT?RT\n");
  EXPECT_TRUE(second.Hears(&server, "OK\r\n5000\r\n"));
  first.heard.clear();
  first.Say("AT?L\n");
  EXPECT_TRUE(first.Hears(&server, "ERROR NO CONTROL\r\n"));
  close(second.stream);
  second.stream = -1;
  for (int k = 0; k < 50; ++k) server.Serve(server.Now() + 1'000'000);
  first.Say("AT?L\n");
  EXPECT_TRUE(first.Hears(&server, "0\r\n"));
}

TEST(ModemPorts, AModemWithoutPowerHasNoPort) {
  ModemServer server(ModemsWith(kNet, kNet), "");
  Client before(*server.port(0));
  before.Say("AT!RT900\n");
  EXPECT_TRUE(before.Hears(&server, "[*]OK\r\n"));
  server.SetPresent(0, false);
  EXPECT_FALSE(before.Hears(&server, "anything"));
  EXPECT_TRUE(before.gone);
  const sockaddr_in place = PlaceOf(*server.port(0));
  const int refused = socket(AF_INET, SOCK_STREAM, 0);
  EXPECT_NE(connect(refused, reinterpret_cast<const sockaddr*>(&place), sizeof(place)), 0);
  close(refused);
  server.SetPresent(0, true);
  for (int k = 0; k < 5; ++k) server.Serve(server.Now() + 1'000'000);
  Client after(*server.port(0));
  after.Say("AT?RT\n");
  EXPECT_TRUE(after.Hears(&server, "5000\r\n")) << "it was not stored";
}

TEST(ModemPorts, ASlowLineTakesItsTime) {
  ModemServer server(ModemsWith(kNet + ", serial_baud: 300", kNet), "");
  Client client(*server.port(0));
  const TimeNs start = SteadyNow();
  client.Say("AT?MODE\nAT?AL\n");
  EXPECT_TRUE(client.Hears(&server, "NET\r\n1\r\n"));
  EXPECT_GE(SteadyNow() - start, 8 * 10 * 1'000'000'000LL / 300);  // eight bytes of ten bits
}

TEST(ModemPorts, SettingsOfTheFileAreStored) {
  ModemServer server(ModemsWith(kNet + ", settings: {L: 2, RT: 3000}", kNet), "");
  Client client(*server.port(0));
  client.Say("AT?L\nAT?RT\nAT!RT5000\nAT?RT\n");
  EXPECT_TRUE(client.Hears(&server, "2\r\n3000\r\n[*]OK\r\n[*]5000\r\n"));
}

TEST(ModemPorts, AClientThatVanishesMakesRoomForTheNext) {
  ModemServer server(ModemsWith(kNet, kNet), "");
  {
    Client client(*server.port(0));
    client.Say("AT?A");
    server.Serve(server.Now());
  }
  for (int k = 0; k < 50; ++k) server.Serve(server.Now() + 1'000'000);
  Client next(*server.port(0));
  next.Say("AT?AL\n");
  EXPECT_TRUE(next.Hears(&server, "1\r\n"));
}

TEST(ModemPorts, AFloodDisturbsNobodyElse) {
  ModemServer server(ModemsWith(kNet, kNet), "");
  Client flood(*server.port(0)), quiet(*server.port(1));
  const std::string noise(60'000, 'x');
  for (int k = 0; k < 20; ++k) {
    (void)!write(flood.stream, noise.data(), noise.size());
    server.Serve(server.Now());
  }
  quiet.Say("AT?AL\n");
  EXPECT_TRUE(quiet.Hears(&server, "2\r\n"));
}

/// One client misbehaves at the first modem. The hosts of the two others talk to each other.
struct Disturbance : testing::Test {
  Disturbance()
      : server(ModemsWith(kNet, kNet, kNet), ""),
        alpha(std::make_unique<Client>(*server.port(0))),
        beta(*server.port(1)),
        gamma(*server.port(2)) {}
  /// Both others are still answered, and a message passes.
  void OthersTalk() {
    beta.heard.clear();
    gamma.heard.clear();
    const std::uint64_t dropped = server.port(1)->dropped() + server.port(2)->dropped();
    beta.Say("AT*SENDIM,5,3,ack,hello\n");
    EXPECT_TRUE(gamma.Hears(&server, "RECVIM,5,2,3,ack,"));
    EXPECT_TRUE(beta.Hears(&server, "DELIVEREDIM,3\r\n"));
    EXPECT_EQ(server.port(1)->dropped() + server.port(2)->dropped(), dropped);
  }
  /// The first port serves the next client.
  void TheNextIsServed() {
    alpha.reset();
    for (int k = 0; k < 5000 && server.port(0)->connected(); ++k) {
      server.Serve(server.Now() + 1'000'000);
    }
    Client next(*server.port(0));
    next.Say("AT?AL\n");
    EXPECT_TRUE(next.Hears(&server, "1\r\n"));
  }
  ModemServer server;
  std::unique_ptr<Client> alpha;
  Client beta, gamma;
};

TEST_F(Disturbance, AFloodOfCommands) {
  std::string flood;
  for (int k = 0; k < 4000; ++k) flood += "AT?CLOCK\nAT&V\n+++AT";
  for (int k = 0; k < 20; ++k) {
    (void)!send(alpha->stream, flood.data(), flood.size(), MSG_NOSIGNAL);
    server.Serve(server.Now());
  }
  OthersTalk();
  TheNextIsServed();
}

TEST_F(Disturbance, AClientThatNeverReads) {
  const std::string ask = "AT&V\nAT&V\nAT&V\nAT&V\n";
  for (int k = 0; k < 20'000 && server.port(0)->dropped() == 0; ++k) {
    (void)!send(alpha->stream, ask.data(), ask.size(), MSG_NOSIGNAL);
    server.Serve(server.Now());
  }
  EXPECT_GT(server.port(0)->dropped(), 0u);
  OthersTalk();
  TheNextIsServed();
}

TEST_F(Disturbance, AClientThatClosesItsHalf) {
  alpha->Say("AT*SENDIM,5,2,ack,hel");
  shutdown(alpha->stream, SHUT_WR);
  OthersTalk();
  TheNextIsServed();
}

TEST_F(Disturbance, AClientThatVanishesWithMuchToRead) {
  const std::string ask = "AT&V\nAT&V\nAT&V\nAT&V\n";
  for (int k = 0; k < 200; ++k) {
    (void)!send(alpha->stream, ask.data(), ask.size(), MSG_NOSIGNAL);
    server.Serve(server.Now());
  }
  // This resets the connection instead of closing it.
  const linger at_once{1, 0};
  setsockopt(alpha->stream, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
  alpha.reset();
  OthersTalk();
  TheNextIsServed();
}

TEST(ModemPorts, ASerialDeviceIsOneMorePort) {
  const int host = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  ASSERT_TRUE(host >= 0 && grantpt(host) == 0 && unlockpt(host) == 0);
  const std::string device = ptsname(host);
  ModemServer server(ModemsWith("interpreter: net, baud: 9600, serial: " + device, kNet), "");
  for (int k = 0; k < 5; ++k) server.Serve(server.Now() + 1'000'000);
  Client beta(*server.port(1));
  const std::string message = "AT*SENDIM,5,2,noack,hello\r";
  ASSERT_EQ(write(host, message.data(), message.size()), static_cast<ssize_t>(message.size()));
  EXPECT_TRUE(beta.Hears(&server, "RECVIM,5,1,2,noack,"));
  std::array<char, 256> buffer;
  const ssize_t size = read(host, buffer.data(), buffer.size());
  EXPECT_EQ(std::string(buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))),
            "OK\r\n");
  close(host);
  // The device is gone. The server goes on and looks for it again.
  beta.heard.clear();
  beta.Say("AT?AL\n");
  EXPECT_TRUE(beta.Hears(&server, "2\r\n"));
}

TEST(ModemPorts, ATerminalIsOneMorePort) {
  const std::string link = testing::TempDir() + "/modem_link_" + std::to_string(getpid());
  {
    ModemServer server(ModemsWith("protocol: s2c, interpreter: net, pty: " + link, kNet), "");
    const int host = open(link.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_GE(host, 0);
    ASSERT_EQ(write(host, "AT?AL\r", 6), 6);
    std::string heard;
    const TimeNs end = SteadyNow() + 10'000'000'000;
    while (heard.find("1\r\n") == std::string::npos && SteadyNow() < end) {
      server.Serve(server.Now() + 2'000'000);
      std::array<char, 256> buffer;
      const ssize_t size = read(host, buffer.data(), buffer.size());
      if (size > 0) heard.append(buffer.data(), static_cast<std::size_t>(size));
    }
    EXPECT_EQ(heard, "1\r\n");
    close(host);
  }
  EXPECT_NE(access(link.c_str(), F_OK), 0);
}

TEST(ModemPorts, FilesThatCannotWorkAreRefused) {
  const auto refused = [](const std::string& alpha, const std::string& beta) {
    EXPECT_THROW(ModemsWith(alpha, beta), UserError) << alpha << " " << beta;
  };
  refused("protocol: s2c", kNet);
  refused("protocol: morse, tcp: 0", kNet);
  refused("protocol: s2c, tcp: 9201", "protocol: s2c, tcp: 9201");
  refused("protocol: s2c, tcp: 0, address: 2", kNet);
  refused("protocol: s2c, tcp: 0, colour: red", kNet);
  refused(kNet + ", settings: {L: 4}", kNet);
  refused(kNet + ", settings: {QQ: 1}", kNet);
  refused(kNet + ", settings: {AL: 3}", kNet);
  refused(kNet + ", clients: 0", kNet);
  refused("protocol: s2c, pty: /tmp/none, clients: 2", kNet);
  refused("protocol: s2c, serial: /dev/none, serial_baud: 9600", kNet);
  refused(kNet + ", baud: 9600", kNet);
  const ScratchFile deaf(
      "vehicles: [{name: a, position_m: [0.0, 0.0, -9.0], modem: {protocol: s2c, pty: "
      "/tmp/none}}]\n"
      "channel: {model: physical}\nlisten: 0.0.0.0\n");
  EXPECT_THROW(LoadModemFile(deaf.path()), UserError);
  const ScratchFile ranged(
      "vehicles: [{name: a, position_m: [0.0, 0.0, -9.0], modem: {protocol: s2c, tcp: 0}}]\n"
      "channel: {model: physical, range_m: 9.0}\n");
  EXPECT_THROW(LoadModemFile(ranged.path()), UserError);
}

}  // namespace
}  // namespace stg::acoustics

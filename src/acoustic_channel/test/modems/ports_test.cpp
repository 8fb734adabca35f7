#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <string>

#include "acoustic_channel/emulator/modem_server.hpp"
#include "auv_common/error.hpp"

/// Emulated modems behind sockets and terminals, in real time.
namespace stg::acoustics {
namespace {

std::string FileWith(const std::string& alpha, const std::string& beta) {
  const std::string path = testing::TempDir() + "/modems_" + std::to_string(getpid()) + ".yaml";
  std::ofstream(path)
      << "vehicles:\n"
         "  - {name: alpha, position_m: [0.0, 0.0, -20.0], modem: {"
      << alpha << "}}\n  - {name: beta, position_m: [150.0, 0.0, -20.0], modem: {" << beta
      << "}}\nchannel:\n  model: physical\n  access: aloha\n  physical:\n    modem:\n"
         "      profile: evologics_s2c\n      queue: fifo\n";
  return path;
}

/// A client of one port.
struct Client {
  explicit Client(const BytePort& port) {
    const int number = std::stoi(port.name().substr(port.name().rfind(':') + 1));
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(static_cast<std::uint16_t>(number));
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    stream = socket(AF_INET, SOCK_STREAM, 0);
    EXPECT_EQ(connect(stream, reinterpret_cast<sockaddr*>(&place), sizeof(place)), 0);
    fcntl(stream, F_SETFL, O_NONBLOCK);
  }
  ~Client() { close(stream); }
  void Say(const std::string& text) const {
    EXPECT_EQ(write(stream, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  /// Whether this is heard within ten seconds.
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
  ModemServer server(LoadModemFile(FileWith(kNet, kNet)), "");
  Client alpha(*server.port(0)), beta(*server.port(1));
  alpha.Say("AT*SENDIM,5,2,ack,hello\n");
  EXPECT_TRUE(beta.Hears(&server, "RECVIM,5,1,2,ack,"));
  EXPECT_TRUE(alpha.Hears(&server, "DELIVEREDIM,2\r\n"));
}

TEST(ModemPorts, ASecondClientIsRefusedAndTheFirstGoesOn) {
  ModemServer server(LoadModemFile(FileWith(kNet, kNet)), "");
  Client first(*server.port(0));
  first.Say("AT?AL\n");
  EXPECT_TRUE(first.Hears(&server, "1\r\n"));
  Client second(*server.port(0));
  EXPECT_FALSE(second.Hears(&server, "anything"));
  EXPECT_TRUE(second.gone);
  first.Say("AT?RT\n");
  EXPECT_TRUE(first.Hears(&server, "5000\r\n"));
}

TEST(ModemPorts, AClientThatVanishesMakesRoomForTheNext) {
  ModemServer server(LoadModemFile(FileWith(kNet, kNet)), "");
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
  ModemServer server(LoadModemFile(FileWith(kNet, kNet)), "");
  Client flood(*server.port(0)), quiet(*server.port(1));
  const std::string noise(60'000, 'x');
  for (int k = 0; k < 20; ++k) {
    (void)!write(flood.stream, noise.data(), noise.size());
    server.Serve(server.Now());
  }
  quiet.Say("AT?AL\n");
  EXPECT_TRUE(quiet.Hears(&server, "2\r\n"));
}

TEST(ModemPorts, ATerminalIsOneMorePort) {
  const std::string link = testing::TempDir() + "/modem_link_" + std::to_string(getpid());
  {
    ModemServer server(
        LoadModemFile(FileWith("protocol: s2c, interpreter: net, pty: " + link, kNet)), "");
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
    EXPECT_THROW(LoadModemFile(FileWith(alpha, beta)), UserError) << alpha << " " << beta;
  };
  refused("protocol: s2c", kNet);
  refused("protocol: morse, tcp: 0", kNet);
  refused("protocol: s2c, tcp: 9201", "protocol: s2c, tcp: 9201");
  refused("protocol: s2c, tcp: 0, address: 2", kNet);
  refused("protocol: s2c, tcp: 0, colour: red", kNet);
}

}  // namespace
}  // namespace stg::acoustics

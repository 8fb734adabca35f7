#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acoustic_channel/channel_config.hpp"
#include "acoustic_channel/micromodem/lbl.hpp"

namespace stg::acoustics {

/// What a modem and its host speak.
enum class Protocol { kS2c, kMicromodem, kJanus };
/// Which bytes of an s2c modem are commands: lines that start with AT, or framed ones.
enum class Interpreter { kAt, kNet };

/// The modem of one vehicle and the port for its host.
struct ModemPlace {
  Protocol protocol = Protocol::kS2c;
  int tcp = -1;         ///< port to listen on, 0: any; -1: none
  std::string pty;      ///< symbolic link to make to a pseudo terminal
  std::string serial;   ///< device
  int baud = 19200;     ///< of `serial`
  int serial_baud = 0;  ///< the output takes the time of such a line; 0: none
  int clients = 1;      ///< of `tcp` and s2c: one client commands, the others read
  std::vector<std::pair<std::string, std::string>> settings{};  ///< stored at power on
  int address = 0;                                              ///< 0: the id and one
  int broadcast = -1;                                           ///< -1: 255 of s2c, 0 of micromodem
  std::string firmware;                        ///< empty: 1.9 of s2c, 2.0.35490 of micromodem
  Interpreter interpreter = Interpreter::kAt;  ///< of s2c
  bool pps = false;                            ///< of micromodem: a tick at each second of UTC
  bool defer = true;                           ///< of s2c, as the next one
  double rssi_offset_db = -190.0;
};

/// A real modem as a node of the simulated water. It sends the packets that the node receives, and
/// the node sends the packets that the modem receives.
struct GatewayPlace {
  std::string protocol = "s2c";  ///< of DriverProtocols()
  std::string port;              ///< tcp://HOST:PORT or a serial device
  int baud = 19200;
  int address = 0;  ///< of the modem; 0: the id and one
};

/// A vehicle in the water of emulated modems.
struct ModemVehicle {
  std::string name;
  int id = 0;
  std::string odom;                    ///< topic of its odometry
  bool moored = false;                 ///< it stays at position_m and has no odometry
  std::array<double, 3> position_m{};  ///< ENU, z up
  std::optional<ModemPlace> modem;
  std::optional<GatewayPlace> gateway;
  std::optional<micromodem::TransponderOptions> transponder;

  /// Whether it sends and receives by ROS topics.
  bool ordinary() const { return !modem && !gateway && !transponder; }
};

/// Emulated modems, their vehicles and their water.
struct ModemFile {
  std::string listen = "127.0.0.1";  ///< address of TCP ports
  NetworkConfig network;
  std::vector<ModemVehicle> vehicles;
};

/// Reads a file with the list `vehicles`, the address `listen`, and the keys of a network file:
/// seed, time, channel. Throws UserError with file, line and key, also if two vehicles share a
/// name, an id or a port.
ModemFile LoadModemFile(const std::string& path);

/// The reason why a modem with a protocol cannot have the profile; empty: it can.
std::string WhyNot(Protocol protocol, const std::string& profile);

}  // namespace stg::acoustics

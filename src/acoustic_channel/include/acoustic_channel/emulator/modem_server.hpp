#pragma once

#include <deque>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/driver/modem_port.hpp"
#include "acoustic_channel/emulator/modem_file.hpp"
#include "acoustic_channel/emulator/modem_water.hpp"
#include "acoustic_channel/ports/byte_port.hpp"
#include "acoustic_channel/s2c/bystander.hpp"

namespace stg::acoustics {

/// Emulated modems behind real ports, in real time: one thread waits for their bytes, stamps them
/// with the time of arrival, and advances the water.
class ModemServer : private ModemHosts {
 public:
  /// Opens the ports. Throws UserError.
  /// @param command_log CSV file of all host input with times, from which a run can be
  ///        replayed; empty: none
  ModemServer(const ModemFile& file, const std::string& command_log);

  ModemWater& water() { return water_; }
  /// Waits for bytes, for the next event of the water, or for the time `until` (of the network),
  /// and processes all due events.
  void Serve(TimeNs until);
  /// Whether a vehicle is in the water. The modem of a vehicle outside the water has no power: its
  /// TCP port is closed, its serial line is silent, and it restarts when the vehicle is back.
  void SetPresent(int node, bool present);
  /// Time of the network now: since the server was made.
  TimeNs Now() const { return SteadyNow() - start_; }

  const BytePort* port(int node) const {
    return places_[static_cast<std::size_t>(node)].port.get();
  }
  /// The driver of a gateway node; null: the node is not a gateway.
  const ModemPort* gateway(int node) const {
    return places_[static_cast<std::size_t>(node)].gateway.get();
  }
  std::uint64_t bytes_read() const { return bytes_read_; }
  /// Messages for the user: a port has a client, two modems have one address.
  std::function<void(const std::string&)> say = [](const std::string&) {};

 private:
  /// Bytes on a slow line, by the steady clock.
  struct Late {
    TimeNs due;
    std::string bytes;
  };
  struct Place {
    std::unique_ptr<BytePort> port;
    PortListener listener;
    std::string name;
    std::unique_ptr<ModemPort> gateway;
    bool power = true;
    bool net = false;                        ///< the interpreter of S2C
    std::map<int, s2c::Bystander> guests{};  ///< by their numbers at the port
    int serial_baud = 0;                     ///< of the emulated line; 0: none
    std::deque<Late> late{};
    TimeNs line_free = 0;
  };
  void Write(int node, const std::string& bytes) override;
  void HangUp(int node) override;
  void OnSharedAddress(int node, int address) override;
  void Announce(int node, const std::string& notification) override;
  void ListenToGuests(int node, PortListener* listener);
  void WriteLate(TimeNs now);
  PortListener ListenerOf(int node);
  void OpenGateway(int node, const GatewayPlace& gateway);
  /// Both ways.
  void PassOn(int node);
  void Log(int node, const char* what, const char* bytes, std::size_t size);

  TimeNs start_ = SteadyNow();
  ModemWater water_;
  std::vector<Place> places_;
  std::vector<BytePort*> ports_;
  std::ofstream log_;
  std::uint64_t bytes_read_ = 0;
  std::vector<Reception> heard_;
};

/// The engine for a place.
std::unique_ptr<ModemEngine> MakeEngine(const ModemPlace& place, ModemSurroundings* world);

}  // namespace stg::acoustics

#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acoustic_channel/modem/packet.hpp"

/// The host's side of a modem: sends packets to it and takes receptions from it.
namespace stg::acoustics {

/// A packet for a modem to send.
struct DriverPacket {
  std::uint32_t tag = 0;
  int destination = 0;  ///< address; kToAll: all
  std::string payload;
};

/// What a modem has received.
struct DriverReception {
  int source = 0;       ///< address
  int destination = 0;  ///< address, or kToAll
  std::string payload;
  TimeNs arrival = 0;              ///< when its last bytes came through the port
  double airtime_s = 0.0;          ///< 0: the modem does not state it
  double received_level_db = 0.0;  ///< re 1 uPa; this and the next two 0: not stated
  double noise_level_db = 0.0, sinr_db = 0.0;
  double doppler_mps = 0.0;  ///< positive closing
};

/// Callbacks of a driver.
class DriverWorld {
 public:
  virtual ~DriverWorld() = default;
  /// Bytes for the modem.
  virtual void Write(const std::string& bytes) = 0;
  /// The modem does not answer: the port must close and reopen the connection.
  virtual void HangUp() = 0;

  virtual void OnReception(const DriverReception& reception) = 0;
  virtual void OnQueued(std::uint32_t /*tag*/) {}
  virtual void OnSent(std::uint32_t /*tag*/, TimeNs /*t*/) {}
  /// A packet has left; `airtime_s` is the modem's statement.
  virtual void OnSendEnd(std::uint32_t /*tag*/, double /*airtime_s*/) {}
  /// A newer packet replaced it before the modem took it, or it was lost with the connection.
  virtual void OnDropped(std::uint32_t /*tag*/) {}
  virtual void OnRefused(std::uint32_t /*tag*/, const std::string& /*why*/) {}
  /// A ping has ended; `one_way_s` < 0: without answer.
  virtual void OnRange(int /*address*/, double /*one_way_s*/) {}
};

/// Protocol engines on the host's side: bytes and time in, bytes out, without ports or clocks. They
/// handle one command and one packet at a time; of the waiting packets they keep the newest. After
/// three commands without an answer they request a new connection and repeat all settings. Times
/// must not go back.
class ModemDriver {
 public:
  /// @param world must live as long as this object
  explicit ModemDriver(DriverWorld* world) : world_(world) {}
  virtual ~ModemDriver() = default;
  ModemDriver(const ModemDriver&) = delete;
  ModemDriver& operator=(const ModemDriver&) = delete;

  void Connect(TimeNs t);
  void Disconnect(TimeNs t);
  virtual void Read(TimeNs t, ByteView bytes) = 0;
  void Send(const DriverPacket& packet, TimeNs t);
  /// Requests the range to a modem; OnRange gets the result.
  void Ping(int address, TimeNs t);
  void Tick(TimeNs t);
  TimeNs next() const;

  /// The modem is set up and answers.
  bool ready() const { return ready_; }
  /// The modem's description of itself; empty: not received yet.
  const std::string& firmware() const { return firmware_; }
  struct Counts {
    std::uint64_t sent = 0, received = 0, lost = 0, dropped = 0, refused = 0, connections = 0;
  };
  const Counts& counts() const { return counts_; }

 protected:
  virtual void Reset() = 0;                               ///< drops all input, commands and packets
  virtual std::vector<std::string> Settings() const = 0;  ///< commands after a connection is made
  virtual std::string CommandFor(const DriverPacket& packet) const = 0;
  virtual std::string PingFor(int address) const = 0;

  // For input.
  void Ask(const std::string& command, TimeNs t);
  /// The unanswered command, without its end of line; empty: none.
  const std::string& asked() const { return asked_; }
  /// The command is answered; sends the next one.
  void Answered(TimeNs t);
  /// The present packet: the modem took it; it is leaving; it has left; the modem refused it; the
  /// driver offers it again later.
  void Taken(TimeNs t);
  void Leaving(TimeNs t);
  void Left(double airtime_s, TimeNs t);
  void Refuse(const std::string& why, TimeNs t);
  void TryAgain(TimeNs t);
  void Receive(const DriverReception& reception);
  void EndPing(double one_way_s, TimeNs t);
  bool sending() const { return under_way_.has_value(); }

  DriverWorld* world_;
  std::string firmware_;
  Counts counts_;
  int ping_ = 0;  ///< the pinged address; 0: none

 private:
  void Go(TimeNs t);
  void AskNext(TimeNs t);

  bool connected_ = false, ready_ = false;
  std::deque<std::string> commands_;
  std::string asked_;
  int times_asked_ = 0;
  TimeNs answer_due_ = 0;
  std::optional<DriverPacket> waiting_, under_way_;
  bool taken_ = false;
  TimeNs again_ = 0;    ///< the next try comes not before this time, because the modem was busy
  TimeNs give_up_ = 0;  ///< for the present packet or ping
};

/// Options of a driver.
struct DriverOptions {
  int address = 1;                 ///< address that the modem gets
  int broadcast = -1;              ///< address of all; -1: 255 of s2c, 0 of micromodem
  double rssi_offset_db = -190.0;  ///< of s2c: from a level re 1 uPa to dB re 1 V
};

std::vector<std::string> DriverProtocols();
/// @param protocol of DriverProtocols(); another one throws UserError
std::unique_ptr<ModemDriver> MakeModemDriver(const std::string& protocol,
                                             const DriverOptions& options, DriverWorld* world);

}  // namespace stg::acoustics

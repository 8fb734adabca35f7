#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acoustic_channel/engine/modem_engine.hpp"
#include "acoustic_channel/s2c/connection.hpp"
#include "acoustic_channel/s2c/header.hpp"
#include "acoustic_channel/s2c/reader.hpp"
#include "acoustic_channel/s2c/settings.hpp"

namespace stg::acoustics::s2c {

/// Options of an emulated S2C modem.
struct ModemOptions {
  bool net = false;     ///< the interpreter of its port: NET, else AT
  int address = 1;      ///< at power on
  int broadcast = 255;  ///< the address of all
  bool defer = true;    ///< instant messages wait for the end of a reception; false: they end it
  double rssi_offset_db = -190.0;  ///< from a level re 1 uPa to dB re 1 V
  std::string firmware = "1.9";
  /// Names and values that are stored at power on.
  std::vector<std::pair<std::string, std::string>> settings{};
};

/// The mode of bursts of a modem with a profile.
ModemProfile BurstMode(const ModemProfile& own);

/// An emulated EvoLogics S2C modem: interpreters AT and NET, instant messages with and without
/// acknowledgement, synchronous and piggyback messages, bursts over a connection, settings and
/// queries. Times in notifications are the times of the first sound, by the modem's clock.
class S2cModem : public ModemEngine {
 public:
  /// @param world must live as long as this object
  S2cModem(const ModemOptions& options, ModemSurroundings* world);

  void Start(TimeNs t) override;
  void Connect(TimeNs t) override;
  void Disconnect(TimeNs t) override;
  void Read(TimeNs t, ByteView bytes) override;
  void Handle(const ModemEvent& event) override;
  void Tick(TimeNs t) override;
  TimeNs next() const override;

  /// For tests and diagnostics.
  const Settings& settings() const { return settings_; }

 private:
  enum class State { kListen, kNoise, kDeaf };
  /// The present instant message.
  struct Message {
    enum class Step { kWaiting, kOffered, kSending, kAwaitingAck };
    Step step = Step::kWaiting;
    PacketHeader header;
    std::string payload;
    int retries_left = 0;
    std::uint32_t tag = 0;
    TimeNs sent = 0, airtime = 0;
    TimeNs deadline = 0;  ///< of kAwaitingAck
    bool timed = false;   ///< synchronous, and to leave at `start`
    TimeNs start = 0;
  };
  struct Ack {
    PacketHeader header;
    TimeNs due = 0;
    std::uint32_t tag = 0;  ///< 0: not given to the network
  };
  /// Of the last reception or acknowledgement, for queries.
  struct Measured {
    int rssi = 0, integrity = 0;
    double velocity_mps = 0.0;
    std::uint32_t propagation_us = 0, duration_us = 0;
    double delay_level_db = 0.0;
  };

  // s2c_modem.cpp: lines in, lines out, time
  void Work(TimeNs t);
  void Obey(const Item& item, TimeNs t);
  void Answer(const std::string& name, const std::string& text);
  void AnswerLines(const std::string& name, const std::string& lines);
  void Notify(const std::string& text);
  void SetMode(Reader::Mode mode);
  void Reboot(TimeNs t);
  std::uint32_t ClockUs(TimeNs t) const;
  /// Network time at which the modem's clock shows `clock_us`, near t.
  TimeNs TimeOfClock(std::uint32_t clock_us, TimeNs t) const;

  // commands.cpp
  void Command(const std::string& text, TimeNs t);
  void Query(const std::string& name, const std::string& text, TimeNs t);
  void Change(char group, const std::string& name, const std::string& value);
  void Control(const std::string& text, TimeNs t);
  std::string Status() const;
  std::string Delivery() const;

  // messages.cpp
  void Send(const Item& item, TimeNs t);
  std::string SendIm(PacketHeader header, const std::string& payload, const std::string& flag,
                     TimeNs t);
  std::string SendIms(PacketHeader header, const std::string& payload, const std::string& clock,
                      TimeNs t);
  std::string SendPbm(const PacketHeader& header, const std::string& payload);
  bool WrongDestination(int address, bool broadcast) const;
  void Launch(TimeNs t);
  void LaunchAck(TimeNs t);
  void GiveUp(const std::string& word);
  void DropMessages(bool tell);

  // bursts.cpp
  std::string SendBurst(const PacketHeader& header, const std::string& payload, TimeNs t);
  bool ControlConnection(const std::string& text, TimeNs t);
  void TakeRaw(const std::string& bytes, TimeNs t);
  void HeedSettings();
  void LaunchBurst(TimeNs t);
  void TakeConnectionPacket(const PacketHeader& header, const ModemEvent& event);
  void TellBurst(const PacketHeader& header, const ModemEvent& event);

  // receptions.cpp
  void OnSent(const PacketInfo& packet, TimeNs t);
  void OnSendEnd(const PacketInfo& packet, TimeNs t);
  void OnReceptionEnd(const ModemEvent& event);
  void Measure(const ModemEvent& event, bool failed);
  void TakeMessage(const PacketHeader& header, const ModemEvent& event);
  void TakeAck(const PacketHeader& header, const ModemEvent& event);
  PacketHeader HeaderOf(const PacketInfo& packet) const;
  std::string Signal() const;

  ModemOptions options_;
  ModemSurroundings* world_;
  Settings settings_;
  Reader reader_;
  bool connected_ = false;
  TimeNs silence_ = 0;  ///< since when the host has been silent
  bool awaits_silence_ = false;
  TimeNs power_on_ = 0;
  State state_ = State::kListen;
  std::optional<Message> message_;
  std::string delivery_ = "EMPTY";        ///< AT?DI, of the last one
  std::map<int, std::string> piggyback_;  ///< by destination
  std::deque<Ack> acks_;
  Connection connection_;
  ModemProfile burst_mode_;
  std::uint32_t burst_tag_ = 0;  ///< of the connection's packet in the network; 0: none
  std::uint32_t tag_ = 0;
  bool sending_ = false, receiving_ = false;
  Measured measured_;
  std::uint64_t sent_count_ = 0, received_count_ = 0, failed_count_ = 0;
};

}  // namespace stg::acoustics::s2c

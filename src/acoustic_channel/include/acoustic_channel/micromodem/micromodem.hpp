#pragma once

#include <array>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acoustic_channel/engine/modem_engine.hpp"
#include "acoustic_channel/micromodem/header.hpp"
#include "acoustic_channel/micromodem/lbl.hpp"
#include "acoustic_channel/micromodem/modes.hpp"
#include "acoustic_channel/micromodem/sentence.hpp"

namespace stg::acoustics::micromodem {

inline constexpr TimeNs kSecondNs = 1'000'000'000;
/// A packet that has not left by then is given up; the longest one takes some seconds.
inline constexpr TimeNs kSendingTimeout = 30 * kSecondNs;

/// Options of an emulated Micromodem.
struct ModemOptions {
  int address = 1;                     ///< SRC at power on, 1 to 127
  int broadcast = 0;                   ///< the address of all
  std::string firmware = "2.0.35490";  ///< 2 and above: a Micromodem-2, which knows more commands
  bool pps = false;                    ///< a line that ticks at each second of UTC is connected
  /// Settings at power on: names and values.
  std::vector<std::pair<std::string, std::string>> settings{};
};

/// An emulated WHOI Micromodem: cycles at the rates 0 to 6 with polls, acknowledgements and data
/// requests, mini-packets, pings, LBL ranging, flexible data packets, settings and clock. Sleeping
/// and hardware lines are not emulated. A packet is lost as a whole: then all of its frames have a
/// bad CRC.
class Micromodem : public ModemEngine {
 public:
  /// @param world must live as long as this object
  Micromodem(const ModemOptions& options, ModemSurroundings* world);

  void Start(TimeNs t) override;
  void Connect(TimeNs t) override;
  void Disconnect(TimeNs t) override;
  void Read(TimeNs t, ByteView bytes) override;
  void Handle(const ModemEvent& event) override;
  void Tick(TimeNs t) override;
  TimeNs next() const override;

  /// Present state, for tests.
  enum class State {
    kBoot,         ///< until the first CAREV
    kIdle,         ///< also while it waits for an answer that may never come
    kCycleTx,      ///< the start of a cycle leaves
    kDataRequest,  ///< the modem asks the host for frames
    kDataTx,       ///< they leave
    kHeardCycle,   ///< another modem's frames must follow
    kPacketTx,     ///< a ping, mini-packet or flexible data packet leaves
    kRanging,      ///< a ping for transponders leaves, and their replies arrive
  };
  State state() const { return state_; }

 private:
  /// The frames that the modem requests from the host.
  struct Cycle {
    PacketHeader header;
    int wanted = 0;
    std::vector<std::string> frames;
  };
  /// A packet that the modem sends by itself after its turnaround.
  struct Answer {
    TimeNs due = 0;
    PacketHeader header;
  };
  /// A packet that leaves at a full second (SNV).
  struct Synchronous {
    TimeNs due = 0;
    PacketHeader header;
    std::string payload;
    std::size_t air_bytes = 0;
  };
  struct Ping {
    bool open = false;
    int destination = 0;
    TimeNs sent = 0, airtime = 0;
  };

  /// Ranging on a long baseline.
  struct LblRanging {
    LblSound ping;
    std::array<int, kLblSlots> wanted{};  ///< 0: no; otherwise 1 or, narrowband, the frequency
    std::array<std::optional<double>, kLblSlots> travel_s{};
    TimeNs timeout = 0, airtime = 0;
    std::optional<TimeNs> sent;  ///< when the ping began to leave
  };

  // micromodem.cpp: lines in, lines out, time
  void Say(const std::vector<std::string>& fields);
  void Error(TimeNs t, const std::string& module, int number, const std::string& text);
  void Enter(State state, TimeNs until);
  void Reboot(TimeNs t);
  TimeNs Utc(TimeNs t) const;
  /// When the modem's clock shows its next full second.
  TimeNs NextSecond(TimeNs t) const;
  /// Quality of that clock, in the statistics of this firmware.
  int clock_mode() const;
  int setting(const std::string& key) const;
  bool second_generation() const;

  // commands.cpp
  void Obey(const Sentence& sentence, TimeNs t);
  bool ObeySending(const std::vector<std::string>& fields, TimeNs t);
  bool ObeySetting(const std::vector<std::string>& fields, TimeNs t);
  bool ObeyClock(const std::vector<std::string>& fields, TimeNs t);
  bool SetClock(const std::optional<TimeNs>& utc, bool pps, TimeNs t);
  void SetDefaults();
  bool CommandCycle(const std::vector<std::string>& fields, TimeNs t);
  bool CommandFrame(const std::vector<std::string>& fields, bool text, TimeNs t);
  bool CommandPing(const std::vector<std::string>& fields, TimeNs t);
  bool CommandMini(const std::vector<std::string>& fields, TimeNs t);
  bool CommandFlexible(const std::vector<std::string>& fields, TimeNs t);

  // lbl.cpp
  bool CommandLbl(const std::vector<std::string>& fields, TimeNs t);
  void ListenForReplies(bool listen);
  void HandleLbl(const ModemEvent& event);
  void TakeLblReply(const ModemEvent& event);
  void EndRanging(TimeNs t);

  // sending.cpp
  void AskForFrame(TimeNs t);
  void SendFrames(TimeNs t);
  /// At once, or with SNV at the next full second.
  void Transmit(const PacketHeader& header, const std::string& payload, std::size_t air_bytes,
                TimeNs t);
  void TransmitNow(const PacketHeader& header, const std::string& payload, std::size_t air_bytes);
  void OnSent(const PacketInfo& packet, TimeNs t);
  void OnSendEnd(const PacketInfo& packet, TimeNs t);

  // receptions.cpp
  void OnReceptionEnd(const ModemEvent& event);
  PacketHeader HeaderOf(const ModemEvent& event) const;
  void TellCycle(const PacketHeader& header);
  void TakeCycle(const PacketHeader& header, TimeNs t);
  void TakeFrames(const PacketHeader& header, const ModemEvent& event);
  void TakeReply(const PacketHeader& header, const ModemEvent& event);
  void TakeAck(const PacketHeader& header);
  void TellLoss(const PacketHeader& header, const ModemEvent& event);
  bool forMe(const PacketHeader& header) const;

  // statistics.cpp
  void TellReception(const PacketHeader& header, const ModemEvent& event);
  void TellTransmission(const PacketHeader& header, const PacketInfo& packet, int mode, TimeNs t);

  ModemOptions options_;
  ModemSurroundings* world_;
  Modes modes_;
  SentenceReader reader_;
  bool connected_ = false;
  std::map<std::string, std::string> settings_;
  TimeNs clock_offset_ = 0;  ///< of the modem's UTC, as the host set it
  bool clock_set_ = false;
  bool pps_ = false;  ///< a second is one of UTC's: a line ticks, or CCTMS,time,1 was obeyed
  State state_ = State::kBoot;
  TimeNs deadline_ = 0;  ///< of the state; kNever: it has none
  TimeNs revision_ = 0;  ///< when the next CAREV is due
  Cycle cycle_;
  Ping ping_;
  LblRanging ranging_;
  std::deque<Answer> answers_;
  std::optional<Synchronous> synchronous_;
  std::uint32_t tag_ = 0;
  int flexible_id_ = 0;
};

/// HHMMSS, HHMMSS.ffff and others of UTC [ns since 1970]; `format` as strftime takes it, `decimals`
/// of a second behind it.
std::string FormatUtc(TimeNs utc, const char* format, int decimals = 0);

}  // namespace stg::acoustics::micromodem

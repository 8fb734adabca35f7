#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "acoustic_channel/modem/packet.hpp"
#include "acoustic_channel/s2c/header.hpp"

namespace stg::acoustics::s2c {

/// Bit rate of a burst [1/s]. The vendor's documents state no rate for this water; it is half of
/// the largest rate in the data sheet of an S2C R 18/34.
inline constexpr double kBurstBitrate = 6900.0;
inline constexpr std::size_t kLongestBurst = 1024;

/// Settings of the modem for its connection.
struct ConnectionSettings {
  int address = 1;
  int repeats = 3;             ///< AT!RC
  TimeNs patience = 0;         ///< AT!RT, for an answer after the last sound
  TimeNs idle = 0;             ///< AT!KO: closed when nothing happened for so long; 0: never
  std::size_t pool_bytes = 0;  ///< AT!PS, of waiting data
};

/// The acoustic connection of a modem with another one. It is established when there is data. Each
/// burst of data is acknowledged or repeated, and both ends may close the connection. The rules are
/// our own, because the vendor's rules are not public. This class has no clock and sends nothing:
/// the modem asks it for the next packet.
class Connection {
 public:
  enum class State { kOffline, kEstablish, kOnline, kBackoff };
  struct Outgoing {
    PacketHeader header;
    std::string payload;
  };

  /// @param tell notifications for the host
  explicit Connection(std::function<void(const std::string&)> tell) : tell_(std::move(tell)) {}

  void Heed(const ConnectionSettings& settings) { settings_ = settings; }
  void Reset();
  State state() const { return state_; }
  int peer() const { return peer_; }
  std::size_t free_bytes() const;

  // Calls for the host. They return answers to commands.
  std::string Add(int destination, int pid, const std::string& data, TimeNs t);
  /// Adds bytes of data mode to the waiting ones.
  std::string AddRaw(int destination, const std::string& data, TimeNs t);
  std::string Dial(int destination, TimeNs t);
  /// @param tell_peer the other end closes, too
  void Close(bool tell_peer);
  /// Drops waiting data and the present burst.
  void Clear();

  // The water.
  /// The packet to send now, once; empty: none.
  std::optional<Outgoing> Next(TimeNs t);
  void OnSendEnd(TimeNs begin, TimeNs end);
  /// It did not leave.
  void OnDiscarded(TimeNs t) { OnSendEnd(t, t); }
  /// A modem wants to connect; true: answer with kAccept.
  bool TakeConnect(int source, TimeNs t);
  /// @return true: this modem is connected now
  bool TakeAccept(int source, TimeNs t);
  void SetPropagation(std::uint32_t us) { propagation_us_ = us; }
  /// A burst has arrived. True: acknowledge it; `fresh`: it is not a repetition.
  bool TakeBurst(const PacketHeader& header, TimeNs t, bool* fresh);
  void TakeBurstAck(const PacketHeader& header, TimeNs t);
  void TakeClose(int source);
  /// Begin and end of the transmission of the packet under way, for ranging.
  TimeNs began() const { return began_; }
  TimeNs ended() const { return ended_; }

  TimeNs next() const;
  void Tick(TimeNs t);

 private:
  enum class Step { kNothing, kReady, kLeaving, kAwaiting };
  struct Chunk {
    int destination = 0, pid = 0;
    bool raw = false;
    std::string data;
  };

  std::string AddChunk(Chunk chunk, TimeNs t);
  void Begin(MessageType type, TimeNs t);
  void Continue(TimeNs t);
  void GoOnline(int peer, TimeNs t);
  void Fail(TimeNs t);
  void Forget();

  std::function<void(const std::string&)> tell_;
  ConnectionSettings settings_;
  State state_ = State::kOffline;
  int peer_ = 0;
  std::deque<Chunk> buffer_;
  Step step_ = Step::kNothing;
  MessageType type_ = MessageType::kConnect;  ///< of the packet under way
  int tries_left_ = 0;
  TimeNs deadline_ = 0;  ///< of kAwaiting
  TimeNs backoff_ = 0;   ///< its end
  TimeNs active_ = 0;    ///< time of the last event
  TimeNs began_ = 0, ended_ = 0;
  int number_ = 0;           ///< of the burst under way, 1 to 255
  int heard_ = 0;            ///< of the last one of the other end
  std::uint32_t count_ = 0;  ///< of commands since the power came on
  std::uint32_t propagation_us_ = 0;
};

}  // namespace stg::acoustics::s2c

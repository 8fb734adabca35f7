#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "acoustic_channel/engine/modem_engine.hpp"
#include "acoustic_channel/janus/packet.hpp"

namespace stg::acoustics::janus {

/// Options of an emulated JANUS modem.
struct ModemOptions {
  int station = 1;  ///< in packets of class 16 without a station from the host
};

/// Lines of a host, without their ends; a line that is too long comes once, as an empty optional
/// in `Line::text`. The result does not depend on where the stream is split.
class LineReader {
 public:
  static constexpr std::size_t kLongestLine = 4096;
  struct Line {
    std::optional<std::string> text;
  };
  void Reset();
  void Feed(ByteView bytes);
  std::optional<Line> Next();

 private:
  std::string buffer_;
  bool skipping_ = false;
};

/// A JANUS modem whose host sends lines of words `name=value`. The names are options of the public
/// tools janus-tx and janus-rx. JANUS itself defines only the sound, and no protocol with a host.
class JanusModem : public ModemEngine {
 public:
  /// @param world must live as long as this object
  JanusModem(const ModemOptions& options, ModemSurroundings* world);

  void Start(TimeNs t) override;
  void Connect(TimeNs t) override;
  void Disconnect(TimeNs t) override;
  void Read(TimeNs t, ByteView bytes) override;
  void Handle(const ModemEvent& event) override;
  void Tick(TimeNs t) override;
  TimeNs next() const override;

 private:
  using Words = std::map<std::string, std::string>;
  /// The answer to a host instead of ok.
  struct Refusal {
    std::string why;
  };

  void Say(const std::string& line);
  void Obey(const std::string& line, TimeNs t);
  void Transmit(const Words& words, TimeNs t);
  void OnReceptionEnd(const ModemEvent& event);

  // words.cpp; they throw Refusal
  Packet PacketOf(const Words& words) const;
  void SetReference(const Words& words, Packet* packet) const;
  static void SetSchedule(const Words& words, Packet* packet);
  static Words WordsOf(const std::string& line);
  static std::string Tell(const Packet& packet);

  ModemOptions options_;
  ModemSurroundings* world_;
  ModemProfile with_cargo_;  ///< mode of packets with cargo
  LineReader reader_;
  bool connected_ = false;
  bool sending_ = false, receiving_ = false;
  TimeNs give_up_ = 0;  ///< of a packet that never leaves
  TimeNs power_on_ = 0;
  std::uint32_t tag_ = 0;
};

}  // namespace stg::acoustics::janus

#pragma once

#include <cstdint>
#include <deque>

#include "acoustic_channel/engine/modem_engine.hpp"
#include "acoustic_channel/micromodem/header.hpp"
#include "acoustic_channel/micromodem/modes.hpp"

/// Ranging on a long baseline (LBL): a modem pings, transponders answer, each with a sound of its
/// own, and the modem measures the travel times.
namespace stg::acoustics::micromodem {

inline constexpr int kLblSlots = 4;              ///< travel times in one answer: A to D
inline constexpr int kRemusPingMs = 10;          ///< length of a coded ping; nothing is published
inline constexpr int kDefaultTurnaroundMs = 50;  ///< of REMUS transponders

/// A sound of LBL ranging, in Transmission::header.
struct LblSound {
  bool reply = false;
  int channel = 0;  ///< 1 to 4: code of the asking vehicle in a REMUS network; 0: narrowband
  int slot = 0;     ///< of a reply in such a network: 0 to 3 are the transponders A to D
  int hz = 0;       ///< of narrowband sounds
};
std::uint64_t Pack(const LblSound& sound);
LblSound UnpackLbl(std::uint64_t header);
inline bool IsLbl(const PacketInfo& packet) {
  return Unpack(packet.header).type == PacketType::kLbl;
}

/// The packet of a sound of so many milliseconds. `modes` must outlive the run.
Transmission LblTransmission(const LblSound& sound, int ms, std::uint32_t tag, const Modes& modes);

/// Options of an emulated transponder.
struct TransponderOptions {
  int slot = -1;                             ///< 0 to 3: A to D of a REMUS network; -1: narrowband
  int query_hz = 0, reply_hz = 0;            ///< of narrowband transponders
  int turnaround_ms = kDefaultTurnaroundMs;  ///< from the end of a ping to the start of the reply
};

/// An emulated transponder. It has no host.
class Transponder : public ModemEngine {
 public:
  /// @param world must live as long as this object
  Transponder(const TransponderOptions& options, ModemSurroundings* world);

  void Start(TimeNs /*t*/) override { answers_.clear(); }
  void Connect(TimeNs /*t*/) override {}
  void Disconnect(TimeNs /*t*/) override {}
  void Read(TimeNs /*t*/, ByteView /*bytes*/) override {}
  void Handle(const ModemEvent& event) override;
  void Tick(TimeNs t) override;
  TimeNs next() const override;

 private:
  struct Answer {
    TimeNs due;
    LblSound sound;
  };

  TransponderOptions options_;
  ModemSurroundings* world_;
  Modes modes_;
  std::deque<Answer> answers_;
  std::uint32_t tag_ = 0;
};

}  // namespace stg::acoustics::micromodem

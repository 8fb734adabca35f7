#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "acoustic_channel/channel/packet_observer.hpp"
#include "acoustic_channel/modem/modem_profile.hpp"
#include "acoustic_channel/modem/packet.hpp"

/// A modem that speaks its own protocol, apart from sockets, threads and clocks.
namespace stg::acoustics {

/// What happens to a modem in the water.
struct ModemEvent {
  enum class Kind {
    kSent,          ///< a packet of its own begins to leave
    kSendEnd,       ///< and has left
    kDiscarded,     ///< or never leaves
    kAcquired,      ///< the modem locks onto a packet, for any destination
    kReceptionEnd,  ///< and lets go of it
  };
  Kind kind = Kind::kSent;
  TimeNs t = 0;
  PacketInfo packet;
  HeardEnd end;                       ///< of kReceptionEnd; its payload points into `payload`
  std::vector<std::uint8_t> payload;  ///< of a packet that the modem could read
};

/// What a modem may do: talk to its host and to the water. Times are the network's.
class ModemSurroundings {
 public:
  virtual ~ModemSurroundings() = default;

  /// The host is given these bytes.
  virtual void Write(const std::string& bytes) = 0;
  /// Programs that read along beside the host hear of it, too: no answer, and not yet framed.
  virtual void Announce(const std::string& /*notification*/) {}
  /// The connection to the host is closed, where it is one.
  virtual void HangUp() = 0;

  /// A packet leaves now, or as soon as the modem may send. Source and stamps are filled in here.
  virtual void Send(Transmission packet) = 0;
  /// See Network::Cancel.
  virtual bool TakeBack(std::uint32_t tag) = 0;

  /// The address by which other modems call this one.
  virtual void SetAddress(int address) = 0;
  /// The node with an address; kToNobody: there is none.
  virtual int NodeOf(int address) const = 0;
  virtual int AddressOf(int node) const = 0;

  virtual const ModemProfile& profile() const = 0;
  /// Waveforms that the modem decodes besides that of its profile.
  virtual void SetWaveforms(std::vector<std::string> waveforms) = 0;
  /// What the modem's own clock shows [s].
  virtual double ClockS(TimeNs t) const = 0;
  /// Coordinated universal time at network time 0 [ns since 1970].
  virtual TimeNs utc_start() const = 0;
  /// Of the water at the modem [m/s].
  virtual double SoundSpeed() const = 0;
};

/// A modem's firmware: bytes, events and time in, bytes and packets out. What comes out depends on
/// what came in and its times, and on nothing else. Times never go back.
class ModemEngine {
 public:
  virtual ~ModemEngine() = default;

  /// The power comes on.
  virtual void Start(TimeNs t) = 0;
  /// A host connects, or goes: half a line dies with it.
  virtual void Connect(TimeNs t) = 0;
  virtual void Disconnect(TimeNs t) = 0;
  /// Bytes of the host.
  virtual void Read(TimeNs t, ByteView bytes) = 0;
  virtual void Handle(const ModemEvent& event) = 0;
  /// To be called at next(), where nothing else happens before.
  virtual void Tick(TimeNs t) = 0;
  /// When the modem wants to be called; kNever: it waits for others.
  virtual TimeNs next() const = 0;
};

}  // namespace stg::acoustics

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "acoustic_channel/channel/packet_observer.hpp"
#include "acoustic_channel/modem/modem_profile.hpp"
#include "acoustic_channel/modem/packet.hpp"

/// A modem with its own protocol, without sockets, threads and clocks.
namespace stg::acoustics {

/// An event of a modem in the water.
struct ModemEvent {
  enum class Kind {
    kSent,          ///< its own transmission begins
    kSendEnd,       ///< its own transmission has ended
    kDiscarded,     ///< its packet never leaves
    kAcquired,      ///< the modem locks onto a packet, for any destination
    kReceptionEnd,  ///< the reception has ended
  };
  Kind kind = Kind::kSent;
  TimeNs t = 0;
  PacketInfo packet;
  HeardEnd end;                       ///< of kReceptionEnd; its payload points into `payload`
  std::vector<std::uint8_t> payload;  ///< of a packet that the modem could read
};

/// Connects a modem to its host and to the water, in the times of the network.
class ModemSurroundings {
 public:
  virtual ~ModemSurroundings() = default;

  /// Sends bytes to the host.
  virtual void Write(const std::string& bytes) = 0;
  /// Sends a notification, without frame, to the other clients that read along.
  virtual void Announce(const std::string& /*notification*/) {}
  /// Closes the connection to the host, if there is one.
  virtual void HangUp() = 0;

  /// Sends a packet now, or as soon as the modem may send. Source and stamps are set here.
  virtual void Send(Transmission packet) = 0;
  /// See Network::Cancel.
  virtual bool TakeBack(std::uint32_t tag) = 0;

  /// Sets the address of this modem.
  virtual void SetAddress(int address) = 0;
  /// The node with an address; kToNone: there is none.
  virtual int NodeOf(int address) const = 0;
  virtual int AddressOf(int node) const = 0;

  virtual const ModemProfile& profile() const = 0;
  /// Waveforms that the modem decodes in addition to its profile's.
  virtual void SetWaveforms(std::vector<std::string> waveforms) = 0;
  /// Time of the modem's own clock [s].
  virtual double ClockS(TimeNs t) const = 0;
  /// Coordinated universal time at network time 0 [ns since 1970].
  virtual TimeNs utc_start() const = 0;
  /// Sound speed at the modem [m/s].
  virtual double SoundSpeed() const = 0;
};

/// A modem's firmware: bytes, events and time in, bytes and packets out. The output depends only on
/// the input and its times. Times must not go back.
class ModemEngine {
 public:
  virtual ~ModemEngine() = default;

  /// Switches the modem on.
  virtual void Start(TimeNs t) = 0;
  /// A host connects or disconnects; an incomplete line is dropped.
  virtual void Connect(TimeNs t) = 0;
  virtual void Disconnect(TimeNs t) = 0;
  /// Takes bytes from the host.
  virtual void Read(TimeNs t, ByteView bytes) = 0;
  virtual void Handle(const ModemEvent& event) = 0;
  /// Must be called at next(), if there is no earlier event.
  virtual void Tick(TimeNs t) = 0;
  /// Time of the next call; kNever: none is needed.
  virtual TimeNs next() const = 0;
};

}  // namespace stg::acoustics

#pragma once

#include <poll.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "auv_common/time.hpp"

/// Streams of bytes: sockets, pseudo terminals and serial lines with one interface for poll(2). No
/// function blocks.
namespace stg::acoustics {

/// Callbacks of a port.
struct PortListener {
  std::function<void()> connected;
  std::function<void()> disconnected;
  std::function<void(const char* bytes, std::size_t size)> read;
  /// The port refused a client, because it has no free place.
  std::function<void()> refused = [] {};
  /// For further clients, which read along (see MakeTcpServer).
  std::function<void(int guest)> guest_came = [](int) {};
  std::function<void(int guest)> guest_left = [](int) {};
  std::function<void(int guest, const char* bytes, std::size_t size)> guest_read =
      [](int, const char*, std::size_t) {};
};

/// One stream at a time. Up to 256 KiB that the other side does not read are kept; more is dropped
/// and counted. A connection that is not read for ten seconds is closed.
class BytePort {
 public:
  virtual ~BytePort();
  BytePort(const BytePort&) = delete;
  BytePort& operator=(const BytePort&) = delete;

  /// Appends the file descriptors for poll.
  virtual void Watch(std::vector<pollfd>* watched) const;
  /// Accepts, connects, reads and writes what is possible now [ns of any clock that does not jump].
  /// Reads at most 16 KiB, so that a client that sends too much does not delay others.
  virtual void Serve(TimeNs now, const PortListener& listener);
  /// Earliest time at which Serve must be called without an event.
  virtual TimeNs next() const;
  void Write(const std::string& bytes);
  /// Closes all connections; the port waits for new ones.
  virtual void HangUp() { hang_up_ = true; }
  /// False: no client can connect, and connected ones are hung up.
  virtual void SetOpen(bool /*open*/) {}

  // For guests; only for ports that accept guests.
  virtual void WriteToGuest(int /*guest*/, const std::string& /*bytes*/) {}
  /// The guest becomes the commanding client, and the commanding client becomes the guest of this
  /// number.
  virtual void GiveControlTo(int /*guest*/, const PortListener& /*listener*/) {}

  bool connected() const { return stream_ >= 0; }
  std::uint64_t dropped() const { return dropped_; }
  /// A description, such as "tcp 127.0.0.1:9201".
  const std::string& name() const { return name_; }

 protected:
  explicit BytePort(std::string name) : name_(std::move(name)) {}
  /// False: the stream stays open even if no program reads it or a hang-up is requested (a
  /// terminal).
  virtual bool closes() const { return true; }
  void Open(int stream);
  void Close(const PortListener& listener);
  void ReadSome(const PortListener& listener);
  void WriteSome(TimeNs now, const PortListener& listener);
  /// Exchanges the connections of two ports, with the bytes that wait to be written.
  void Exchange(BytePort* other);

  std::string name_;
  int stream_ = -1;

 private:
  std::string out_;
  TimeNs stalled_ = -1;  ///< time since which nothing could be written
  bool hang_up_ = false;
  std::uint64_t dropped_ = 0;
};

/// Listens on an address. `read` and Write concern the first client. Up to `clients` - 1 more are
/// guests; when the first client disconnects, the oldest guest takes its place. All others are
/// refused. Throws UserError if the port is not available. Port 0: any free one.
std::unique_ptr<BytePort> MakeTcpServer(const std::string& address, int port, int clients = 1);
/// Connects, and again after 1, 2, 4, ... up to 30 s.
std::unique_ptr<BytePort> MakeTcpClient(const std::string& host, int port);
/// A pseudo terminal, raw, without echo, mode 0600; `link` becomes a symbolic link to it and is
/// removed at the end. Throws UserError if `link` exists, unless it is a broken link of an earlier
/// run. @param link empty: none
std::unique_ptr<BytePort> MakePty(const std::string& link);
/// A serial device, raw. Opened again when it vanishes.
std::unique_ptr<BytePort> MakeSerial(const std::string& device, int baud);

/// tcp://HOST:PORT or a serial device. Throws UserError for anything else.
std::unique_ptr<BytePort> MakePortTo(const std::string& where, int baud);

/// Waits until something happens at a port, or `until` by the steady clock.
void WaitForPorts(const std::vector<BytePort*>& ports, TimeNs until);
/// Of the steady clock.
TimeNs SteadyNow();

}  // namespace stg::acoustics

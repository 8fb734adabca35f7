#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/ports/byte_port.hpp"
#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

constexpr TimeNs kFirstWait = 1'000'000'000, kLongestWait = 30'000'000'000;

void SendAtOnce(int stream) {
  const int on = 1;
  setsockopt(stream, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
}

[[noreturn]] void Fail(const std::string& name) {
  throw UserError(name + ": " + std::strerror(errno));
}

/// A client in addition to the first one.
class Guest : public BytePort {
 public:
  Guest(int number, int stream) : BytePort("guest"), number_(number) { Open(stream); }
  int number() const { return number_; }

 private:
  int number_;
};

class TcpServer : public BytePort {
 public:
  TcpServer(const std::string& address, int port, int clients)
      : BytePort("tcp " + address), most_guests_(static_cast<std::size_t>(clients) - 1) {
    name_ += ":" + std::to_string(port);
    place_.sin_family = AF_INET;
    place_.sin_port = htons(static_cast<std::uint16_t>(port));
    if (inet_pton(AF_INET, address.c_str(), &place_.sin_addr) != 1) {
      throw UserError("listen: '" + address + "' is not an IPv4 address");
    }
    if (!Listen()) Fail(name_);
    name_ = "tcp " + address + ":" + std::to_string(ntohs(place_.sin_port));
  }
  ~TcpServer() override {
    if (listener_ >= 0) close(listener_);
  }

  void Watch(std::vector<pollfd>* watched) const override {
    if (listener_ >= 0) watched->push_back({listener_, POLLIN, 0});
    BytePort::Watch(watched);
    for (const auto& guest : guests_) guest->Watch(watched);
  }
  TimeNs next() const override {
    TimeNs first = BytePort::next();
    if (wants_listener()) first = std::min(first, retry_);
    for (const auto& guest : guests_) first = std::min(first, guest->next());
    return first;
  }
  void Serve(TimeNs now, const PortListener& listener) override {
    // A client that has disconnected makes room for the next one.
    BytePort::Serve(now, listener);
    ServeGuests(now, listener);
    if (wants_listener() && now >= retry_ && !Listen()) retry_ = now + kFirstWait;
    if (!open_ || listener_ < 0) return;
    for (;;) {
      const int client = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
      if (client < 0) return;
      SendAtOnce(client);
      Welcome(client, now, listener);
    }
  }

  void SetOpen(bool open) override {
    open_ = open;
    if (open) return;
    if (listener_ >= 0) close(listener_);
    listener_ = -1;
    HangUp();
  }
  void HangUp() override {
    BytePort::HangUp();
    for (const auto& guest : guests_) guest->HangUp();
  }
  void WriteToGuest(int number, const std::string& bytes) override {
    for (const auto& guest : guests_) {
      if (guest->number() == number) guest->Write(bytes);
    }
  }
  void GiveControlTo(int number, const PortListener& listener) override {
    for (const auto& guest : guests_) {
      if (guest->number() != number) continue;
      if (connected()) listener.disconnected();
      Exchange(guest.get());
      listener.connected();
      return;
    }
  }

 private:
  bool wants_listener() const { return open_ && listener_ < 0; }
  /// Returns false if the address is not available now; errno has the reason.
  bool Listen() {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const int on = 1;
    setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
    if (bind(listener_, reinterpret_cast<sockaddr*>(&place_), sizeof(place_)) != 0 ||
        listen(listener_, 4) != 0) {
      const int error = errno;
      close(listener_);
      listener_ = -1;
      errno = error;
      return false;
    }
    socklen_t size = sizeof(place_);
    getsockname(listener_, reinterpret_cast<sockaddr*>(&place_), &size);
    return true;
  }
  void Welcome(int client, TimeNs now, const PortListener& listener) {
    if (!connected()) {
      Open(client);
      listener.connected();
      BytePort::Serve(now, listener);
    } else if (guests_.size() < most_guests_) {
      guests_.push_back(std::make_unique<Guest>(++last_guest_, client));
      listener.guest_came(last_guest_);
    } else {
      close(client);
      listener.refused();
    }
  }
  void ServeGuests(TimeNs now, const PortListener& listener) {
    // One of them may become the client in this loop. Then its number has another meaning.
    for (std::size_t k = 0; k < guests_.size(); ++k) {
      const int number = guests_[k]->number();
      PortListener of_guest;
      of_guest.read = [&](const char* bytes, std::size_t size) {
        listener.guest_read(number, bytes, size);
      };
      of_guest.disconnected = [&] { listener.guest_left(number); };
      guests_[k]->Serve(now, of_guest);
    }
    const auto gone = [](const std::unique_ptr<Guest>& guest) { return !guest->connected(); };
    guests_.erase(std::remove_if(guests_.begin(), guests_.end(), gone), guests_.end());
    if (connected() || guests_.empty()) return;
    listener.guest_left(guests_.front()->number());
    Exchange(guests_.front().get());
    guests_.erase(guests_.begin());
    listener.connected();
  }

  sockaddr_in place_{};
  std::size_t most_guests_;
  bool open_ = true;
  int listener_ = -1;
  TimeNs retry_ = 0;
  std::vector<std::unique_ptr<Guest>> guests_;
  int last_guest_ = 0;
};

class TcpClient : public BytePort {
 public:
  TcpClient(const std::string& host, int port)
      : BytePort("tcp " + host + ":" + std::to_string(port)), host_(host), port_(port) {}
  ~TcpClient() override {
    if (trying_ >= 0) close(trying_);
  }

  void Watch(std::vector<pollfd>* watched) const override {
    if (trying_ >= 0) watched->push_back({trying_, POLLOUT, 0});
    BytePort::Watch(watched);
  }
  TimeNs next() const override { return connected() || trying_ >= 0 ? BytePort::next() : retry_; }
  void Serve(TimeNs now, const PortListener& listener) override {
    const bool before = connected();
    BytePort::Serve(now, listener);
    if (connected()) return;
    if (before) Later(now, true);
    if (trying_ < 0 && now >= retry_) Try(now);
    if (trying_ >= 0) Finish(now, listener);
  }

 private:
  void Later(TimeNs now, bool first) {
    if (trying_ >= 0) close(trying_);
    trying_ = -1;
    wait_ = first ? kFirstWait : std::min(2 * wait_, kLongestWait);
    retry_ = now + wait_;
  }
  void Try(TimeNs now) {
    addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    if (getaddrinfo(host_.c_str(), std::to_string(port_).c_str(), &hints, &found) != 0) {
      return Later(now, false);
    }
    trying_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const int result = connect(trying_, found->ai_addr, found->ai_addrlen);
    freeaddrinfo(found);
    if (result != 0 && errno != EINPROGRESS) Later(now, false);
  }
  void Finish(TimeNs now, const PortListener& listener) {
    pollfd ready{trying_, POLLOUT, 0};
    if (poll(&ready, 1, 0) <= 0) return;
    int error = 0;
    socklen_t size = sizeof(error);
    getsockopt(trying_, SOL_SOCKET, SO_ERROR, &error, &size);
    if (error != 0) return Later(now, false);
    SendAtOnce(trying_);
    Open(trying_);
    trying_ = -1;
    wait_ = kFirstWait / 2;
    listener.connected();
    BytePort::Serve(now, listener);
  }

  std::string host_;
  int port_;
  int trying_ = -1;
  TimeNs retry_ = 0, wait_ = kFirstWait / 2;
};

}  // namespace

std::unique_ptr<BytePort> MakeTcpServer(const std::string& address, int port, int clients) {
  return std::make_unique<TcpServer>(address, port, clients);
}
std::unique_ptr<BytePort> MakeTcpClient(const std::string& host, int port) {
  return std::make_unique<TcpClient>(host, port);
}

std::unique_ptr<BytePort> MakePortTo(const std::string& where, int baud) {
  const std::string scheme = "tcp://";
  if (where.compare(0, scheme.size(), scheme) != 0) return MakeSerial(where, baud);
  const std::size_t colon = where.rfind(':');
  const std::string host = where.substr(scheme.size(), colon - scheme.size());
  int port = 0;
  try {
    port = colon > scheme.size() ? std::stoi(where.substr(colon + 1)) : 0;
  } catch (const std::exception&) {
    port = 0;
  }
  if (host.empty() || port < 1 || port > 65535) {
    throw UserError("port: '" + where + "' is not tcp://HOST:PORT");
  }
  return MakeTcpClient(host, port);
}

}  // namespace stg::acoustics

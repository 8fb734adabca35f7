#include "acoustic_channel/ports/byte_port.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <utility>

#include "acoustic_channel/access/medium_access.hpp"

namespace stg::acoustics {
namespace {

constexpr std::size_t kMostWaiting = 256 * 1024;
constexpr TimeNs kMostPatience = 10'000'000'000;
constexpr std::size_t kReadAtOnce = 16 * 1024;

/// If the other end of a socket is closed, this is an error here, not a signal.
ssize_t WriteTo(int stream, const std::string& bytes) {
  const ssize_t size = send(stream, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  return size < 0 && errno == ENOTSOCK ? write(stream, bytes.data(), bytes.size()) : size;
}

bool Again() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

TimeNs SteadyNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void WaitForPorts(const std::vector<BytePort*>& ports, TimeNs until) {
  std::vector<pollfd> watched;
  for (const BytePort* port : ports) {
    port->Watch(&watched);
    until = std::min(until, port->next());
  }
  const TimeNs wait = std::max<TimeNs>(0, until - SteadyNow());
  timespec timeout{};
  timeout.tv_sec = static_cast<time_t>(wait / 1'000'000'000);
  timeout.tv_nsec = static_cast<long>(wait % 1'000'000'000);
  ppoll(watched.data(), watched.size(), &timeout, nullptr);
}

BytePort::~BytePort() {
  if (stream_ >= 0) close(stream_);
}

void BytePort::Open(int stream) {
  fcntl(stream, F_SETFL, fcntl(stream, F_GETFL) | O_NONBLOCK);
  fcntl(stream, F_SETFD, FD_CLOEXEC);
  stream_ = stream;
  out_.clear();
  stalled_ = -1;
  hang_up_ = false;
}

void BytePort::Close(const PortListener& listener) {
  if (stream_ < 0) return;
  close(stream_);
  stream_ = -1;
  out_.clear();
  hang_up_ = false;
  listener.disconnected();
}

void BytePort::Exchange(BytePort* other) {
  std::swap(stream_, other->stream_);
  std::swap(out_, other->out_);
  std::swap(stalled_, other->stalled_);
  std::swap(hang_up_, other->hang_up_);
}

void BytePort::Watch(std::vector<pollfd>* watched) const {
  if (stream_ < 0) return;
  const bool writes = !out_.empty();
  watched->push_back({stream_, static_cast<short>(writes ? POLLIN | POLLOUT : POLLIN), 0});
}

TimeNs BytePort::next() const {
  return stalled_ >= 0 && closes() ? stalled_ + kMostPatience : kNever;
}

void BytePort::Write(const std::string& bytes) {
  if (stream_ < 0) return;
  if (out_.size() + bytes.size() > kMostWaiting) {
    ++dropped_;
    return;
  }
  out_ += bytes;
}

void BytePort::Serve(TimeNs now, const PortListener& listener) {
  if (stream_ >= 0) ReadSome(listener);
  if (stream_ >= 0) WriteSome(now, listener);
  if (stream_ >= 0 && hang_up_ && closes()) Close(listener);
  hang_up_ = false;
}

void BytePort::ReadSome(const PortListener& listener) {
  std::array<char, kReadAtOnce> buffer;
  const ssize_t size = read(stream_, buffer.data(), buffer.size());
  if (size > 0) {
    listener.read(buffer.data(), static_cast<std::size_t>(size));
  } else if (closes() && (size == 0 || !Again())) {
    Close(listener);
  }
}

void BytePort::WriteSome(TimeNs now, const PortListener& listener) {
  while (!out_.empty()) {
    const ssize_t size = WriteTo(stream_, out_);
    if (size > 0) {
      out_.erase(0, static_cast<std::size_t>(size));
      stalled_ = -1;
      continue;
    }
    if (size < 0 && !Again()) {
      if (closes()) Close(listener);
      return;
    }
    if (stalled_ < 0) stalled_ = now;
    if (now - stalled_ >= kMostPatience && closes()) Close(listener);
    return;
  }
  stalled_ = -1;
}

}  // namespace stg::acoustics

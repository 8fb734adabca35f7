#include <fcntl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/ports/byte_port.hpp"
#include "auv_common/error.hpp"

namespace stg::acoustics {
namespace {

constexpr TimeNs kRetry = 1'000'000'000;

speed_t SpeedOf(int baud) {
  switch (baud) {
    case 4800:
      return B4800;
    case 9600:
      return B9600;
    case 19200:
      return B19200;
    case 38400:
      return B38400;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    default:
      throw UserError("baud: " + std::to_string(baud) + " is not a standard rate of a serial port");
  }
}

void MakeRaw(int terminal, speed_t speed) {
  termios settings{};
  if (tcgetattr(terminal, &settings) != 0) return;
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  cfsetispeed(&settings, speed);
  cfsetospeed(&settings, speed);
  tcsetattr(terminal, TCSANOW, &settings);
}

/// A pseudo terminal of this program. The host's end stays open here, so that hosts may come and
/// go.
class Pty : public BytePort {
 public:
  explicit Pty(const std::string& link) : BytePort("pty"), link_(link) {
    const int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) {
      throw UserError(std::string("pty: ") + std::strerror(errno));
    }
    const std::string slave = ptsname(master);
    slave_ = open(slave.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    MakeRaw(slave_, B19200);
    fchmod(slave_, 0600);
    name_ = "pty " + slave;
    Open(master);
    if (link_.empty()) return;
    struct stat there {};
    if (lstat(link_.c_str(), &there) == 0) {
      const bool leads_nowhere = S_ISLNK(there.st_mode) && access(link_.c_str(), F_OK) != 0;
      if (!leads_nowhere) throw UserError("pty: " + link_ + " exists already");
      unlink(link_.c_str());
    }
    if (symlink(slave.c_str(), link_.c_str()) != 0) {
      throw UserError("pty: " + link_ + ": " + std::strerror(errno));
    }
    linked_ = true;
    name_ = "pty " + link_;
  }
  ~Pty() override {
    if (linked_) unlink(link_.c_str());
    if (slave_ >= 0) close(slave_);
  }

  void Serve(TimeNs now, const PortListener& listener) override {
    if (!announced_) listener.connected();
    announced_ = true;
    BytePort::Serve(now, listener);
  }

 protected:
  bool closes() const override { return false; }

 private:
  std::string link_;
  int slave_ = -1;
  bool linked_ = false, announced_ = false;
};

class Serial : public BytePort {
 public:
  Serial(const std::string& device, int baud)
      : BytePort("serial " + device), device_(device), speed_(SpeedOf(baud)) {}

  TimeNs next() const override { return connected() ? BytePort::next() : retry_; }
  void Serve(TimeNs now, const PortListener& listener) override {
    if (!connected() && now >= retry_) {
      const int stream = open(device_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
      retry_ = now + kRetry;
      if (stream < 0) return;
      MakeRaw(stream, speed_);
      Open(stream);
      listener.connected();
    }
    BytePort::Serve(now, listener);
  }

 private:
  std::string device_;
  speed_t speed_;
  TimeNs retry_ = 0;
};

}  // namespace

std::unique_ptr<BytePort> MakePty(const std::string& link) { return std::make_unique<Pty>(link); }
std::unique_ptr<BytePort> MakeSerial(const std::string& device, int baud) {
  return std::make_unique<Serial>(device, baud);
}

}  // namespace stg::acoustics

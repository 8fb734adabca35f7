#include "acoustic_channel/driver/modem_port.hpp"

#include <algorithm>
#include <utility>

namespace stg::acoustics {

ModemPort::ModemPort(const std::string& protocol, const DriverOptions& options,
                     const std::string& where, int baud)
    : port_(MakePortTo(where, baud)), driver_(MakeModemDriver(protocol, options, this)) {
  listener_.connected = [this] { driver_->Connect(SteadyNow()); };
  listener_.disconnected = [this] { driver_->Disconnect(SteadyNow()); };
  listener_.read = [this](const char* bytes, std::size_t size) {
    driver_->Read(SteadyNow(), {reinterpret_cast<const std::uint8_t*>(bytes), size});
  };
}

void ModemPort::Serve(const std::vector<ModemPort*>& ports, TimeNs until) {
  std::vector<BytePort*> streams;
  for (ModemPort* port : ports) {
    streams.push_back(port->stream());
    until = std::min(until, port->next());
  }
  WaitForPorts(streams, until);
  for (ModemPort* port : ports) port->Work();
}

void ModemPort::Work() {
  port_->Serve(SteadyNow(), listener_);
  const TimeNs now = SteadyNow();
  if (driver_->next() <= now) driver_->Tick(now);
}

std::vector<DriverReception> ModemPort::TakeReceptions() { return std::exchange(received_, {}); }
std::vector<ModemPort::Event> ModemPort::TakeEvents() { return std::exchange(events_, {}); }
std::vector<ModemPort::Range> ModemPort::TakeRanges() { return std::exchange(ranges_, {}); }

void ModemPort::OnQueued(std::uint32_t tag) {
  events_.push_back({Event::Kind::kQueued, tag, SteadyNow(), 0.0, ""});
}
void ModemPort::OnSent(std::uint32_t tag, TimeNs t) {
  events_.push_back({Event::Kind::kSent, tag, t, 0.0, ""});
}
void ModemPort::OnSendEnd(std::uint32_t tag, double airtime_s) {
  events_.push_back({Event::Kind::kSendEnd, tag, SteadyNow(), airtime_s, ""});
}
void ModemPort::OnDropped(std::uint32_t tag) {
  events_.push_back({Event::Kind::kDropped, tag, SteadyNow(), 0.0, "a newer packet replaces it"});
}
void ModemPort::OnRefused(std::uint32_t tag, const std::string& why) {
  events_.push_back({Event::Kind::kRefused, tag, SteadyNow(), 0.0, why});
}

}  // namespace stg::acoustics

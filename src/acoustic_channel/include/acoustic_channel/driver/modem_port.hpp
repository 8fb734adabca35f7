#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/driver/modem_driver.hpp"
#include "acoustic_channel/ports/byte_port.hpp"

namespace stg::acoustics {

/// A driver behind a real port. All times are from SteadyNow().
class ModemPort : private DriverWorld {
 public:
  /// An event of one packet at the modem.
  struct Event {
    enum class Kind { kQueued, kSent, kSendEnd, kDropped, kRefused };
    Kind kind = Kind::kQueued;
    std::uint32_t tag = 0;
    TimeNs t = 0;
    double airtime_s = 0.0;
    std::string text;
  };
  struct Range {
    int address = 0;
    double one_way_s = -1.0;  ///< negative: no answer
  };

  /// @param where tcp://HOST:PORT or a serial device; throws UserError
  ModemPort(const std::string& protocol, const DriverOptions& options, const std::string& where,
            int baud);

  /// Waits for bytes of the ports, or for the time `until`, and processes them and all due events.
  static void Serve(const std::vector<ModemPort*>& ports, TimeNs until);

  /// For a loop that waits for other streams as well: watch this one, then call Work at next().
  BytePort* stream() { return port_.get(); }
  TimeNs next() const { return driver_->next(); }
  void Work();

  ModemDriver& driver() { return *driver_; }
  const ModemDriver& driver() const { return *driver_; }
  bool connected() const { return port_->connected(); }
  const std::string& name() const { return port_->name(); }
  /// Events and receptions since the last call.
  std::vector<DriverReception> TakeReceptions();
  std::vector<Event> TakeEvents();
  std::vector<Range> TakeRanges();

 private:
  void Write(const std::string& bytes) override { port_->Write(bytes); }
  void HangUp() override { port_->HangUp(); }
  void OnReception(const DriverReception& reception) override { received_.push_back(reception); }
  void OnQueued(std::uint32_t tag) override;
  void OnSent(std::uint32_t tag, TimeNs t) override;
  void OnSendEnd(std::uint32_t tag, double airtime_s) override;
  void OnDropped(std::uint32_t tag) override;
  void OnRefused(std::uint32_t tag, const std::string& why) override;
  void OnRange(int address, double one_way_s) override { ranges_.push_back({address, one_way_s}); }

  std::unique_ptr<BytePort> port_;
  std::unique_ptr<ModemDriver> driver_;
  PortListener listener_;
  std::vector<DriverReception> received_;
  std::vector<Event> events_;
  std::vector<Range> ranges_;
};

}  // namespace stg::acoustics

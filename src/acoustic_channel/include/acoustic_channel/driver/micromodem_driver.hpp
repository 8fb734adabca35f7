#pragma once

#include <string>
#include <vector>

#include "acoustic_channel/driver/modem_driver.hpp"
#include "acoustic_channel/micromodem/sentence.hpp"

namespace stg::acoustics::micromodem {

/// Driver of a WHOI Micromodem: packets are flexible data at rate 1. If the modem does not support
/// flexible data, they are cycles at rate 0 with frames of at most 32 bytes.
class MicromodemDriver : public ModemDriver {
 public:
  MicromodemDriver(const DriverOptions& options, DriverWorld* world)
      : ModemDriver(world), options_(options) {}
  void Read(TimeNs t, ByteView bytes) override;

 private:
  using Fields = std::vector<std::string>;

  void Reset() override;
  std::vector<std::string> Settings() const override;
  std::string CommandFor(const DriverPacket& packet) const override;
  std::string PingFor(int address) const override;
  void Take(const Fields& fields, TimeNs t);
  void TakeError(const Fields& fields, TimeNs t);
  void TakeFrame(int source, int destination, const std::string& payload, TimeNs t);
  void TakeStatistics(const Fields& fields);

  DriverOptions options_;
  SentenceReader reader_;
  bool first_generation_ = false;          ///< it has refused flexible data
  mutable std::string frame_;              ///< CCTXD for the data request of a cycle
  std::vector<DriverReception> received_;  ///< their statistics have not come yet
  TimeNs leaves_ = 0;
  bool frame_leaves_ = false;
};

}  // namespace stg::acoustics::micromodem

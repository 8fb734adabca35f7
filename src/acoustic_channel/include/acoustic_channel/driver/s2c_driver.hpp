#pragma once

#include <string>
#include <vector>

#include "acoustic_channel/driver/modem_driver.hpp"
#include "acoustic_channel/s2c/answer_reader.hpp"

namespace stg::acoustics::s2c {

/// Driver of an EvoLogics S2C modem whose port has a NET interpreter: packets are instant messages
/// without acknowledgement, and a ping is an instant message with acknowledgement.
class S2cDriver : public ModemDriver {
 public:
  S2cDriver(const DriverOptions& options, DriverWorld* world)
      : ModemDriver(world), options_(options) {}
  void Read(TimeNs t, ByteView bytes) override;

 private:
  void Reset() override { reader_.Reset(); }
  std::vector<std::string> Settings() const override;
  std::string CommandFor(const DriverPacket& packet) const override;
  std::string PingFor(int address) const override;
  void TakeAnswer(const ModemLine& line, TimeNs t);
  void TakeNotification(const ModemLine& line, TimeNs t);
  void TakeMessage(const ModemLine& line, TimeNs t);

  DriverOptions options_;
  AnswerReader reader_;
};

}  // namespace stg::acoustics::s2c

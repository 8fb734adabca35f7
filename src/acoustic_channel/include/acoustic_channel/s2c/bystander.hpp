#pragma once

#include <string>

#include "acoustic_channel/s2c/reader.hpp"

namespace stg::acoustics::s2c {

/// The modem's side of a connection beside that of the host which is obeyed: it reads all
/// notifications, and its commands are refused until it takes control with AT@CTRL.
class Bystander {
 public:
  /// @param net the interpreter of the port: NET, else AT
  explicit Bystander(bool net);

  /// Answers to bytes. Stops behind a command that takes control, which is not answered here.
  std::string Read(ByteView bytes);
  bool takes_control() const { return takes_control_; }
  /// What was read behind that command; for the modem.
  std::string TakeRest() { return reader_.TakeRest(); }
  /// A notification as it is written here.
  std::string Told(const std::string& notification) const;

 private:
  Reader reader_;
  bool takes_control_ = false;
};

}  // namespace stg::acoustics::s2c

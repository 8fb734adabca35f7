#pragma once

#include <string>

#include "acoustic_channel/s2c/reader.hpp"

namespace stg::acoustics::s2c {

/// The modem's side of an additional connection, beside the one of the host with control. It gets
/// all notifications. Its commands are refused until it takes control with AT@CTRL.
class Bystander {
 public:
  /// @param net the interpreter of the port: NET, else AT
  explicit Bystander(bool net);

  /// Answers to bytes. It stops after a command that takes control, which is not answered here.
  std::string Read(ByteView bytes);
  bool takes_control() const { return takes_control_; }
  /// The bytes after that command, for the modem.
  std::string TakeRest() { return reader_.TakeRest(); }
  /// A notification in the form of this connection.
  std::string Overheard(const std::string& notification) const;

 private:
  Reader reader_;
  bool takes_control_ = false;
};

}  // namespace stg::acoustics::s2c

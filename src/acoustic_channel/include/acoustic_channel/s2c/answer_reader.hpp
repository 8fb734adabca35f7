#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "acoustic_channel/modem/packet.hpp"

namespace stg::acoustics::s2c {

/// An answer or a notification of a modem with a NET interpreter.
struct ModemLine {
  std::vector<std::string> fields;  ///< split at commas, without the payload
  std::string payload;              ///< of RECV, RECVIM, RECVIMS, RECVPBM

  const std::string& name() const { return fields[0]; }
  /// Whether it is a notification, not an answer to a command.
  bool notification() const;
};

/// Cuts the modem's side of the stream into lines; payloads are taken by their length. The result
/// does not depend on where the stream is split. Keeps at most kLongestLine bytes.
class AnswerReader {
 public:
  static constexpr std::size_t kLongestLine = 4096;

  void Reset() { buffer_.clear(); }
  void Feed(ByteView bytes);
  std::optional<ModemLine> Next();

 private:
  std::string buffer_;
};

}  // namespace stg::acoustics::s2c

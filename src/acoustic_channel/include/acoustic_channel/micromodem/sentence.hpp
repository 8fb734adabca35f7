#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "acoustic_channel/engine/text.hpp"
#include "acoustic_channel/modem/packet.hpp"

/// The protocol between WHOI Micromodems and their hosts: sentences as in NMEA 0183. Both ends use
/// the parts of this folder.
namespace stg::acoustics::micromodem {

/// One line: `$CCCYC,0,1,2,0,0,1*5F` is {"CCCYC", "0", "1", "2", "0", "0", "1"}.
struct Sentence {
  std::vector<std::string> fields;  ///< the name first; empty for a broken sentence
  std::string error;                ///< why it could not be read; empty: it was read
};

/// `$BODY*HH` with end of line; HH is the exclusive or of the bytes of the body.
std::string Seal(const std::string& body);
/// The body of fields, without `$` and checksum.
std::string Join(const std::vector<std::string>& fields);

/// Cuts sentences out of a stream of bytes. The result does not depend on where the stream is
/// split. Keeps at most kLongestLine bytes.
class SentenceReader {
 public:
  static constexpr std::size_t kLongestLine = 8192;  ///< 2048 bytes in hexadecimal, and more

  void Reset();
  void Feed(ByteView bytes);
  /// The next sentence; empty: more bytes are needed. Empty lines are skipped.
  std::optional<Sentence> Next();

 private:
  std::string buffer_;
  bool skipping_ = false;  ///< the rest of a line that was too long
};

}  // namespace stg::acoustics::micromodem

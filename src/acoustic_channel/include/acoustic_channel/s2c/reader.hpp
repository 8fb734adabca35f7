#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "acoustic_channel/modem/packet.hpp"

/// The protocol that EvoLogics S2C modems speak with their hosts, as public host software speaks
/// it. Both ends read with the parts of this folder.
namespace stg::acoustics::s2c {

/// A line of the host's, cut out of its stream of bytes.
struct Item {
  enum class Kind {
    kCommand,  ///< `text` without "AT" and end of line: "!AL5"
    kMessage,  ///< the same with `payload`: text "*SENDIM,5,2,ack"
    kData,     ///< `payload` for the acoustic connection (data mode)
    kBroken,   ///< nothing that could be read: `error` says why
    kTooLong,  ///< a payload that no message takes: as long as the host said, and skipped
  };
  Kind kind = Kind::kCommand;
  bool escaped = false;  ///< it began with "+++"
  std::string text;
  std::string payload;
};

/// Cuts lines and binary payloads out of a stream. The result does not depend on where the stream
/// is split. Keeps at most a line of kLongestLine bytes.
class Reader {
 public:
  static constexpr std::size_t kLongestLine = 4096;
  static constexpr std::size_t kLongestPayload = 1024;

  enum class Mode {
    kData,   ///< commands begin with "+++AT", everything else is data
    kPlain,  ///< commands begin with "AT"
  };

  void SetMode(Mode mode) { mode_ = mode; }
  Mode mode() const { return mode_; }
  /// Forgets a half line.
  void Reset();
  void Feed(ByteView bytes);
  /// The next item, in the mode that is in force then; nothing: more bytes are needed.
  std::optional<Item> Next();

  /// Silence of kGuard_s means something here: see OnSilence.
  bool awaits_silence() const { return skipping_ || (!buffer_.empty() && buffer_[0] == '+'); }
  /// A binary payload is not complete.
  bool inside_message() const { return inside_message_; }
  /// The host has been silent for a second. True: it escapes from data mode with a lonely "+++".
  bool OnSilence();
  /// The host has left a message unfinished for seconds: the message is given up.
  void GiveUp();
  /// Bytes that were fed and not yet cut into items; they are forgotten here.
  std::string TakeRest();

 private:
  std::optional<Item> NextData();
  std::optional<Item> NextLine();
  std::optional<Item> NextMessage(std::size_t begin, std::size_t name_end, int fields);
  std::optional<Item> Broken(std::size_t length, const std::string& text);
  /// Removes the first `length` bytes and the end of line behind them.
  void TakeLine(std::size_t length);
  void SkipLine();

  Mode mode_ = Mode::kPlain;
  std::string buffer_;
  bool skipping_ = false;         ///< up to the next end of line
  bool swallow_newline_ = false;  ///< the second half of "\r\n"
  bool inside_message_ = false;
};

/// An answer or notification (of which the name is empty) as the interpreters write it.
std::string Framed(Reader::Mode mode, const std::string& name, const std::string& text);
/// What an answer calls a command; nothing in it could be taken for another field.
std::string NameOf(const std::string& text);

/// A whole number without sign, all of `text`; nothing: it is none, or above 2^32 - 1.
std::optional<std::uint32_t> WholeNumber(const std::string& text);

}  // namespace stg::acoustics::s2c

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "acoustic_channel/modem/packet.hpp"

/// The protocol between EvoLogics S2C modems and their hosts, as public host software uses it. Both
/// ends use the parts of this folder.
namespace stg::acoustics::s2c {

/// A line of the host.
struct Item {
  enum class Kind {
    kCommand,  ///< `text` without "AT" and end of line: "!AL5"
    kMessage,  ///< the same with `payload`: text "*SENDIM,5,2,ack"
    kData,     ///< `payload` for the acoustic connection (data mode)
    kBroken,   ///< unreadable: `error` contains the reason
    kTooLong,  ///< a payload that is too long for any message; it is skipped
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
  /// Drops an incomplete line.
  void Reset();
  void Feed(ByteView bytes);
  /// The next item, in the present mode; empty: more bytes are needed.
  std::optional<Item> Next();

  /// Whether a silence of kGuard_s has a meaning now: see OnSilence.
  bool awaits_silence() const { return skipping_ || (!buffer_.empty() && buffer_[0] == '+'); }
  /// A binary payload is not complete.
  bool inside_message() const { return inside_message_; }
  /// The host has been silent for a second. True: it escapes from data mode with a lonely "+++".
  bool OnSilence();
  /// The host has not finished a message for seconds: the message is dropped.
  void GiveUp();
  /// Returns and removes the bytes that are not yet cut into items.
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
/// The name of a command in an answer, without characters of other fields.
std::string NameOf(const std::string& text);

/// A whole number without sign; empty: `text` contains anything else, or a number above 2^32 - 1.
std::optional<std::uint32_t> WholeNumber(const std::string& text);

}  // namespace stg::acoustics::s2c

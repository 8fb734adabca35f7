#include "acoustic_channel/s2c/reader.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace stg::acoustics::s2c {
namespace {

constexpr char kEscape[] = "+++AT";
constexpr std::size_t kEscapeLength = 5;
constexpr std::size_t kLongestHeader = 128;

/// Commands with a binary payload, and the number of fields between name and payload.
int FieldsOf(const std::string& name) {
  static const std::array<std::pair<const char*, int>, 4> messages{
      {{"*SENDIM", 3}, {"*SENDIMS", 3}, {"*SENDPBM", 2}, {"*SEND", 2}}};
  for (const auto& [known, fields] : messages) {
    if (name == known) return fields;
  }
  return 0;
}

std::size_t FindEnd(const std::string& s, std::size_t from) {
  return s.find_first_of("\r\n", from);
}

}  // namespace

std::string Framed(Reader::Mode mode, const std::string& name, const std::string& text) {
  if (mode == Reader::Mode::kPlain) return text + "\r\n";
  return "+++AT" + name + ":" + std::to_string(text.size()) + ":" + text + "\r\n";
}

std::string NameOf(const std::string& text) {
  constexpr std::size_t kLongest = 16;
  std::size_t end = 0;
  const auto allowed = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string("?!@&*").find(c) != std::string::npos;
  };
  while (end < text.size() && end < kLongest && allowed(text[end])) ++end;
  return text.substr(0, end);
}

std::optional<std::uint32_t> WholeNumber(const std::string& text) {
  if (text.empty() || text.size() > 10) return {};
  std::uint64_t value = 0;
  for (const char c : text) {
    if (c < '0' || c > '9') return {};
    value = 10 * value + static_cast<std::uint64_t>(c - '0');
  }
  if (value > 0xffffffffu) return {};
  return static_cast<std::uint32_t>(value);
}

void Reader::Reset() {
  buffer_.clear();
  skipping_ = swallow_newline_ = inside_message_ = false;
}

void Reader::Feed(ByteView bytes) {
  buffer_.append(reinterpret_cast<const char*>(bytes.data), bytes.size);
}

void Reader::TakeLine(std::size_t length) {
  swallow_newline_ = length < buffer_.size() && buffer_[length] == '\r';
  buffer_.erase(0, length + 1);
}

void Reader::SkipLine() {
  const std::size_t end = FindEnd(buffer_, 0);
  if (end == std::string::npos) {
    buffer_.clear();
    return;
  }
  TakeLine(end);
  skipping_ = false;
}

std::optional<Item> Reader::Next() {
  if (skipping_) SkipLine();
  if (swallow_newline_ && !buffer_.empty()) {
    if (buffer_[0] == '\n') buffer_.erase(0, 1);
    swallow_newline_ = false;
  }
  if (mode_ == Mode::kData) return NextData();
  const std::size_t begin = buffer_.find_first_not_of("\r\n");
  buffer_.erase(0, begin);
  return NextLine();
}

std::optional<Item> Reader::NextData() {
  const std::size_t escape = buffer_.find(kEscape);
  if (escape == 0) return NextLine();
  std::size_t length = escape;
  if (escape == std::string::npos) {
    // Bytes that may be the beginning of an escape are kept.
    std::size_t kept = std::min(buffer_.size(), kEscapeLength - 1);
    while (kept > 0 && buffer_.compare(buffer_.size() - kept, kept, kEscape, kept) != 0) --kept;
    length = buffer_.size() - kept;
  }
  if (length == 0) return {};
  Item item;
  item.kind = Item::Kind::kData;
  item.payload = buffer_.substr(0, length);
  buffer_.erase(0, length);
  return item;
}

std::optional<Item> Reader::Broken(std::size_t length, const std::string& text) {
  Item item;
  item.kind = Item::Kind::kBroken;
  item.escaped = buffer_.compare(0, 3, "+++") == 0;
  item.text = text;
  inside_message_ = false;
  buffer_.erase(0, length);
  skipping_ = true;
  SkipLine();
  return item;
}

std::optional<Item> Reader::NextLine() {
  inside_message_ = false;
  if (buffer_.empty()) return {};
  const bool escaped = buffer_.compare(0, 3, "+++") == 0;
  const std::size_t begin = escaped ? 3 : 0;
  const std::size_t end = FindEnd(buffer_, 0);
  const std::size_t comma = buffer_.find(',');
  if (comma < end && buffer_.compare(begin, 2, "AT") == 0) {
    const int fields = FieldsOf(buffer_.substr(begin + 2, comma - begin - 2));
    if (fields > 0) return NextMessage(begin, comma, fields);
  }
  const std::size_t length = std::min(end, buffer_.size());
  if (length > kLongestLine) return Broken(kLongestLine, "");
  if (end == std::string::npos) return {};
  if (buffer_.compare(begin, 2, "AT") != 0 || end < begin + 2) return Broken(0, "");
  Item item;
  item.escaped = escaped;
  item.text = buffer_.substr(begin + 2, end - begin - 2);
  TakeLine(end);
  return item;
}

std::optional<Item> Reader::NextMessage(std::size_t begin, std::size_t name_end, int fields) {
  const std::string name = buffer_.substr(begin + 2, name_end - begin - 2);
  inside_message_ = true;
  // The first field may be a protocol id, e.g. "p5".
  std::size_t at = name_end + 1, number = at;
  if (at < buffer_.size() && buffer_[at] == 'p') ++fields;
  std::size_t header_end = name_end;
  for (int k = 0; k < fields; ++k) {
    const std::size_t stop = buffer_.find_first_of(",\r\n", at);
    if (stop == std::string::npos || stop > kLongestHeader) {
      if (buffer_.size() <= kLongestHeader) return {};
      return Broken(0, name);
    }
    if (buffer_[stop] != ',') return Broken(0, name);
    if (k == 0 && buffer_[number] == 'p') number = stop + 1;
    header_end = stop;
    at = stop + 1;
  }
  const std::string length_text = buffer_.substr(number, buffer_.find(',', number) - number);
  const std::optional<std::uint32_t> length = WholeNumber(length_text);
  if (!length) return Broken(0, name);
  if (*length > kLongestPayload) {
    std::optional<Item> item = Broken(at, name);
    item->kind = Item::Kind::kTooLong;
    return item;
  }
  const std::size_t payload_end = at + *length;
  if (buffer_.size() <= payload_end) return {};
  const char last = buffer_[payload_end];
  if (last != '\r' && last != '\n') return Broken(payload_end, name);
  Item item;
  item.kind = Item::Kind::kMessage;
  item.escaped = begin > 0;
  item.text = buffer_.substr(begin + 2, header_end - begin - 2);
  item.payload = buffer_.substr(at, *length);
  TakeLine(payload_end);
  inside_message_ = false;
  return item;
}

bool Reader::OnSilence() {
  skipping_ = false;
  if (buffer_ != "+++") return false;
  buffer_.clear();
  return mode_ == Mode::kData;
}

void Reader::GiveUp() {
  if (inside_message_) Reset();
}

std::string Reader::TakeRest() {
  std::string rest;
  rest.swap(buffer_);
  Reset();
  return rest;
}

}  // namespace stg::acoustics::s2c

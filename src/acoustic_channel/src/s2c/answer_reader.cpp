#include "acoustic_channel/s2c/answer_reader.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "acoustic_channel/s2c/reader.hpp"

namespace stg::acoustics::s2c {
namespace {

/// Number of fields before the payload, including the name; 0: there is no payload.
std::size_t FieldsBeforePayload(const std::string& name) {
  if (name == "RECVIM" || name == "RECVIMS" || name == "RECV") return 9;
  return name == "RECVPBM" ? 8 : 0;
}

constexpr std::array<std::string_view, 22> kNotifications = {
    "RECV",       "DELIVERED", "FAILED",      "RADDR",      "BITRATE",     "SRCLEVEL",
    "RECVIM",     "RECVIMS",   "RECVPBM",     "RECVSTART",  "RECVEND",     "RECVFAILED",
    "SENDSTART",  "SENDEND",   "FAILEDIM",    "CANCELEDIM", "DELIVEREDIM", "CANCELEDIMS",
    "EXPIREDIMS", "FAILEDIMS", "CANCELEDPBM", "DROPCNT"};

}  // namespace

bool ModemLine::notification() const {
  return std::find(kNotifications.begin(), kNotifications.end(), fields[0]) != kNotifications.end();
}

void AnswerReader::Feed(ByteView bytes) {
  buffer_.append(reinterpret_cast<const char*>(bytes.data), bytes.size);
}

std::optional<ModemLine> AnswerReader::Next() {
  while (!buffer_.empty() && (buffer_[0] == '\r' || buffer_[0] == '\n')) buffer_.erase(0, 1);
  ModemLine line;
  std::size_t at = 0;
  for (;;) {
    const std::size_t end = buffer_.find_first_of(",\r\n", at);
    if (end == std::string::npos) {
      if (buffer_.size() > kLongestLine) buffer_.clear();
      return {};
    }
    line.fields.push_back(buffer_.substr(at, end - at));
    at = end + 1;
    if (buffer_[end] != ',') break;
    if (line.fields.size() != FieldsBeforePayload(line.name())) continue;
    // RECVIM,[p<pid>,]<length>: the protocol id is an additional field.
    if (!line.fields[1].empty() && line.fields[1][0] == 'p') {
      line.fields.erase(line.fields.begin() + 1);
      continue;
    }
    const auto length = WholeNumber(line.fields[1]);
    if (!length || *length > Reader::kLongestPayload) break;
    if (buffer_.size() < at + *length + 1) return {};
    line.payload = buffer_.substr(at, *length);
    at += *length;
    break;
  }
  buffer_.erase(0, at);
  return line;
}

}  // namespace stg::acoustics::s2c

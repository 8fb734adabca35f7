#include "acoustic_channel/micromodem/sentence.hpp"

#include <charconv>

namespace stg::acoustics::micromodem {
namespace {

constexpr char kDigits[] = "0123456789ABCDEF";

int DigitOf(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

unsigned ChecksumOf(const std::string& body) {
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  return sum;
}

Sentence Broken(const std::string& why) { return {{}, why}; }

Sentence Parse(const std::string& line) {
  // What stands before the last dollar sign is the rest of a sentence that was cut off.
  const std::size_t dollar = line.rfind('$');
  if (dollar == std::string::npos) return Broken("no dollar sign");
  std::string body = line.substr(dollar + 1);
  const std::size_t star = body.find('*');
  if (star != std::string::npos) {
    const bool whole = body.size() == star + 3;
    const int high = whole ? DigitOf(body[star + 1]) : -1;
    const int low = whole ? DigitOf(body[star + 2]) : -1;
    body.resize(star);
    const bool sound = high >= 0 && low >= 0;
    if (!sound || ChecksumOf(body) != static_cast<unsigned>(high * 16 + low)) {
      return Broken("bad checksum");
    }
  }
  Sentence sentence;
  std::size_t at = 0;
  for (;;) {
    const std::size_t comma = body.find(',', at);
    sentence.fields.push_back(body.substr(at, comma == std::string::npos ? comma : comma - at));
    if (comma == std::string::npos) return sentence;
    at = comma + 1;
  }
}

}  // namespace

std::string Seal(const std::string& body) {
  const unsigned sum = ChecksumOf(body);
  return "$" + body + "*" + kDigits[sum >> 4] + kDigits[sum & 0xf] + "\r\n";
}

std::string Join(const std::vector<std::string>& fields) {
  std::string body;
  for (const std::string& field : fields) body += (&field == fields.data() ? "" : ",") + field;
  return body;
}

void SentenceReader::Reset() {
  buffer_.clear();
  skipping_ = false;
}

void SentenceReader::Feed(ByteView bytes) {
  buffer_.append(reinterpret_cast<const char*>(bytes.data), bytes.size);
}

std::optional<Sentence> SentenceReader::Next() {
  for (;;) {
    const std::size_t end = buffer_.find_first_of("\r\n");
    if (skipping_) {
      if (end == std::string::npos) {
        buffer_.clear();
        return {};
      }
      buffer_.erase(0, end + 1);
      skipping_ = false;
      continue;
    }
    if (end > kLongestLine && buffer_.size() > kLongestLine) {
      buffer_.erase(0, kLongestLine + 1);
      skipping_ = true;
      return Broken("line too long");
    }
    if (end == std::string::npos) return {};
    const std::string line = buffer_.substr(0, end);
    buffer_.erase(0, end + 1);
    if (!line.empty()) return Parse(line);
  }
}

std::string ToHex(const std::string& bytes) {
  std::string digits;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    digits += kDigits[byte >> 4];
    digits += kDigits[byte & 0xf];
  }
  return digits;
}

std::optional<std::string> FromHex(const std::string& digits) {
  if (digits.size() % 2 != 0) return {};
  std::string bytes;
  for (std::size_t k = 0; k < digits.size(); k += 2) {
    const int high = DigitOf(digits[k]), low = DigitOf(digits[k + 1]);
    if (high < 0 || low < 0) return {};
    bytes += static_cast<char>(high * 16 + low);
  }
  return bytes;
}

std::optional<int> NumberIn(const std::string& text, int lowest, int highest) {
  int value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = end.ec == std::errc() && end.ptr == text.data() + text.size();
  if (!whole || value < lowest || value > highest) return {};
  return value;
}

}  // namespace stg::acoustics::micromodem

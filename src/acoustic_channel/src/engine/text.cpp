#include "acoustic_channel/engine/text.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>

namespace stg::acoustics {
namespace {

constexpr char kDigits[] = "0123456789ABCDEF";
constexpr char kBase64[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

int DigitOf(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

}  // namespace

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

std::string ToBase64(const std::string& bytes) {
  std::string digits;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - k);
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      bits = bits << 8 | (j < count ? static_cast<unsigned char>(bytes[k + j]) : 0u);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      digits += j <= count ? kBase64[bits >> (18 - 6 * j) & 0x3f] : '=';
    }
  }
  return digits;
}

std::optional<int> NumberIn(const std::string& text, int lowest, int highest) {
  int value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = end.ec == std::errc() && end.ptr == text.data() + text.size();
  if (!whole || value < lowest || value > highest) return {};
  return value;
}

std::optional<double> RealIn(const std::string& text, double lowest, double highest) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') ++begin;
  double value = 0.0;
  const auto read = std::from_chars(begin, end, value);
  const bool whole = read.ec == std::errc() && read.ptr == end;
  if (!whole || !(value >= lowest && value <= highest)) return {};
  return value;
}

}  // namespace stg::acoustics

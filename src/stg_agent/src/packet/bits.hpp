#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "stg_agent/packet/packet.hpp"
#include "stg_agent/packet/quantiser.hpp"

/// Codes of numbers and their place in a packet.
namespace stg::agent {

/// Bits [first, first + count) of the packet, least significant bit of byte 0 first.
struct Bits {
  int first, count;
  constexpr int end() const { return first + count; }
};
constexpr Bits After(Bits previous, int count) { return {previous.end(), count}; }

constexpr TimeNs kTick = 1'000'000;  // resolution of times [ns]

constexpr std::size_t kWords = kPacketBytes / 8;
using Words = std::array<std::uint64_t, kWords>;

/// Tables for eight bytes at a time: kCrc[k][b] is the checksum of byte b followed by k zero bytes.
/// Bits are taken least significant first, so that the first bit of the version is the highest
/// power. Because of the polynomial's period of 255, one pair of wrong bits stays undetected. It
/// contains this bit, so the version check detects it.
struct CrcTables {
  std::uint8_t t[8][256];
};
constexpr CrcTables MakeCrcTables() {
  CrcTables tables{};
  for (int b = 0; b < 256; ++b) {
    unsigned crc = static_cast<unsigned>(b);
    for (int i = 0; i < 8; ++i) crc = (crc >> 1) ^ ((crc & 1u) ? 0xB8u : 0u);  // 0x1D reversed
    tables.t[0][b] = static_cast<std::uint8_t>(crc);
  }
  for (int k = 1; k < 8; ++k) {
    for (int b = 0; b < 256; ++b) tables.t[k][b] = tables.t[0][tables.t[k - 1][b]];
  }
  return tables;
}
constexpr CrcTables kCrc = MakeCrcTables();

template <int kBytes>
inline std::uint64_t ExtendCrc(std::uint64_t crc, std::uint64_t word) {
  const std::uint64_t x = word ^ crc;
  std::uint64_t sum = 0;
  for (int i = 0; i < kBytes; ++i) sum ^= kCrc.t[kBytes - 1 - i][(x >> (8 * i)) & 0xFF];
  return sum;
}

/// CRC-8 of all bytes except the last one, which contains it.
inline std::uint64_t Checksum(const Words& words) {
  std::uint64_t crc = 0xFF;  // so that a packet of zeros has a wrong checksum
  for (std::size_t w = 0; w + 1 < kWords; ++w) crc = ExtendCrc<8>(crc, words[w]);
  return ExtendCrc<7>(crc, words[kWords - 1]);
}

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "words are copied as bytes");

// Inlined always, so that shifts and word indices are constants.
[[gnu::always_inline]] inline void Put(Words* words, Bits bits, std::uint64_t code) {
  const auto word = static_cast<std::size_t>(bits.first / 64);
  const int shift = bits.first % 64;
  (*words)[word] |= code << shift;
  if (shift + bits.count > 64) (*words)[word + 1] |= code >> (64 - shift);
}

[[gnu::always_inline]] inline std::uint64_t Get(const Words& words, Bits bits) {
  const auto word = static_cast<std::size_t>(bits.first / 64);
  const int shift = bits.first % 64;
  std::uint64_t code = words[word] >> shift;
  if (shift + bits.count > 64) code |= words[word + 1] << (64 - shift);
  return code & ((std::uint64_t{1} << bits.count) - 1);
}

/// Component `axis` of a field of three equal ones.
constexpr Bits Component(Bits bits, int axis) {
  return {bits.first + axis * (bits.count / 3), bits.count / 3};
}

/// Nearest tick, halves upwards; monotone, so that generation <= now survives the rounding.
inline std::int64_t Ticks(TimeNs t) {
  const TimeNs shifted = t + kTick / 2;
  return shifted / kTick - (shifted % kTick < 0 ? 1 : 0);
}

[[gnu::always_inline]] inline void PutVector(Words* words, Bits bits, const Quantiser& q,
                                             const Vec3<double>& v, bool* saturated) {
  Put(words, Component(bits, 0), Code(q, v.x, saturated));
  Put(words, Component(bits, 1), Code(q, v.y, saturated));
  Put(words, Component(bits, 2), Code(q, v.z, saturated));
}

[[gnu::always_inline]] inline Vec3<double> GetVector(const Words& words, Bits bits,
                                                     const Quantiser& q, bool* unused_code) {
  return {Value(q, Get(words, Component(bits, 0)), unused_code),
          Value(q, Get(words, Component(bits, 1)), unused_code),
          Value(q, Get(words, Component(bits, 2)), unused_code)};
}

}  // namespace stg::agent

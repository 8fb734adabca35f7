#include "acoustic_channel/janus/packet.hpp"

#include <algorithm>
#include <cmath>

namespace stg::acoustics::janus {
namespace {

constexpr int kLastIndex = 127;
constexpr std::size_t kLongestPadded = 480;

/// First and last time of a series, and the factor between two steps.
struct Series {
  double first_s, last_s, factor;
};
Series SeriesOf(Packet::Schedule schedule) {
  if (schedule == Packet::Schedule::kReservation) return {0.0033211, 600.0, 1.1};
  return {0.033211, 31557600.0, 1.17676979};
}

std::size_t PaddedOfCode(std::size_t code) {
  if (code == 0) return 0;
  return code < 4 ? std::size_t{1} << (code - 1) : 8 * (code - 3);
}

}  // namespace

double ScheduleS(Packet::Schedule schedule, int index) {
  if (schedule == Packet::Schedule::kNone) return 0.0;
  const Series s = SeriesOf(schedule);
  return std::min(s.last_s, s.first_s * std::pow(s.factor, index));
}

std::optional<int> ScheduleIndex(Packet::Schedule schedule, double time_s) {
  const Series s = SeriesOf(schedule);
  const double half_step = std::sqrt(s.factor);
  if (!(time_s >= s.first_s / half_step && time_s <= s.last_s * half_step)) return {};
  const long index = std::lround(std::log(time_s / s.first_s) / std::log(s.factor));
  return static_cast<int>(std::clamp<long>(index, 0, kLastIndex));
}

std::array<std::uint8_t, kBaselineBytes> Encode(const Packet& p) {
  const bool scheduled = p.schedule != Packet::Schedule::kNone;
  std::uint64_t bits = kVersion;
  const auto put = [&bits](std::uint64_t value, int count) {
    bits = bits << count | (value & ((std::uint64_t{1} << count) - 1));
  };
  put(p.mobility ? 1 : 0, 1);
  put(scheduled ? 1 : 0, 1);
  put(p.tx_rx ? 1 : 0, 1);
  put(p.forward ? 1 : 0, 1);
  put(static_cast<std::uint64_t>(p.class_id), 8);
  put(static_cast<std::uint64_t>(p.app_type), 6);
  if (scheduled) {
    put(p.schedule == Packet::Schedule::kRepeat ? 1 : 0, 1);
    put(static_cast<std::uint64_t>(p.schedule_index), 7);
  }
  put(p.app_data, p.app_data_bits());
  std::array<std::uint8_t, kBaselineBytes> bytes{};
  for (std::size_t k = 0; k + 1 < kBaselineBytes; ++k) {
    bytes[k] = static_cast<std::uint8_t>(bits >> (48 - 8 * k));
  }
  bytes.back() = Crc8(bytes.data(), kBaselineBytes - 1);
  return bytes;
}

std::optional<Packet> Decode(const std::array<std::uint8_t, kBaselineBytes>& bytes) {
  if (Crc8(bytes.data(), kBaselineBytes - 1) != bytes.back()) return {};
  std::uint64_t bits = 0;
  for (std::size_t k = 0; k + 1 < kBaselineBytes; ++k) bits = bits << 8 | bytes[k];
  int left = 56;
  const auto take = [&](int count) {
    left -= count;
    return bits >> left & ((std::uint64_t{1} << count) - 1);
  };
  if (take(4) != kVersion) return {};
  Packet p;
  p.mobility = take(1) != 0;
  const bool scheduled = take(1) != 0;
  p.tx_rx = take(1) != 0;
  p.forward = take(1) != 0;
  p.class_id = static_cast<int>(take(8));
  p.app_type = static_cast<int>(take(6));
  if (scheduled) {
    p.schedule = take(1) != 0 ? Packet::Schedule::kRepeat : Packet::Schedule::kReservation;
    p.schedule_index = static_cast<int>(take(7));
  }
  p.app_data = take(p.app_data_bits());
  return p;
}

std::optional<std::size_t> PaddedCargo(std::size_t bytes) {
  if (bytes > kLongestPadded) return {};
  std::size_t code = 0;
  while (PaddedOfCode(code) < bytes) ++code;
  return PaddedOfCode(code);
}

std::uint64_t EncodeReference(int app_type, const ReferenceData& d) {
  const auto at = [](std::size_t value, int bit) { return std::uint64_t{value} << bit; };
  const std::uint64_t station = at(static_cast<std::size_t>(d.station), 18);
  if (app_type == 1) {
    return station | at(static_cast<std::size_t>(d.destination), 10) |
           at(d.ack_request ? 1 : 0, 9) | at(d.cargo_bytes, 0);
  }
  std::size_t code = 0;
  while (PaddedOfCode(code) < d.cargo_bytes) ++code;
  return station | at(static_cast<std::size_t>(d.parameter_set), 6) | at(code, 0);
}

ReferenceData DecodeReference(int app_type, std::uint64_t app_data) {
  ReferenceData d;
  d.station = static_cast<int>(app_data >> 18 & 0xff);
  if (app_type == 1) {
    d.destination = static_cast<int>(app_data >> 10 & 0xff);
    d.ack_request = (app_data >> 9 & 1) != 0;
    d.cargo_bytes = app_data & 0xff;
  } else {
    d.parameter_set = static_cast<int>(app_data >> 6 & 0xfff);
    d.cargo_bytes = PaddedOfCode(app_data & 0x3f);
  }
  return d;
}

std::uint8_t Crc8(const std::uint8_t* bytes, std::size_t size) {
  unsigned crc = 0;
  for (std::size_t k = 0; k < size; ++k) {
    crc ^= bytes[k];
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x80) != 0 ? crc << 1 ^ 0x107 : crc << 1;
  }
  return static_cast<std::uint8_t>(crc);
}

std::uint16_t Crc16(const std::string& bytes) {
  unsigned crc = 0;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xa001 : crc >> 1;
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace stg::acoustics::janus

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

/// JANUS (NATO STANAG 4748): the content of packets and its layout.
namespace stg::acoustics::janus {

inline constexpr std::size_t kBaselineBytes = 8;
inline constexpr int kVersion = 3;
/// n bytes of cargo take n + 1 times as long, at 160 chips per second [s].
inline constexpr double kCargoByte_s = 0.1;
/// The class whose packets state the length of their cargo.
inline constexpr int kReferenceClass = 16;
inline constexpr int kToAllStations = 255;

/// The baseline packet of 64 bits, and the cargo behind it.
struct Packet {
  bool mobility = false;
  bool tx_rx = true;     ///< the sender can receive, too
  bool forward = false;  ///< it forwards packets of others
  int class_id = kReferenceClass;
  int app_type = 0;
  /// 34 bits, of a packet with a schedule 26.
  std::uint64_t app_data = 0;
  /// Time of the reservation, or interval of repetition: an index of ScheduleS.
  enum class Schedule { kNone, kReservation, kRepeat };
  Schedule schedule = Schedule::kNone;
  int schedule_index = 0;
  std::string cargo;

  int app_data_bits() const { return schedule == Schedule::kNone ? 34 : 26; }
};

/// Fields of the application data of class 16, types 0 and 1.
struct ReferenceData {
  int station = 0;
  int parameter_set = 0;  ///< of type 0, 12 bits
  int destination = 0;    ///< of type 1, as the next one
  bool ack_request = false;
  std::size_t cargo_bytes = 0;
};

/// The seconds that an index of 0 to 127 stands for: steps of 10 % from 3.3 ms to 10 minutes
/// (reservation), of 17.7 % from 33 ms to a year (repeat). The standard prints the same series with
/// some digits changed, by less than half a step.
double ScheduleS(Packet::Schedule schedule, int index);
/// The index nearest to a time; empty: the time is outside of the series.
std::optional<int> ScheduleIndex(Packet::Schedule schedule, double time_s);

std::array<std::uint8_t, kBaselineBytes> Encode(const Packet& packet);
/// Decodes a packet, without cargo. Empty: wrong checksum, or another version.
std::optional<Packet> Decode(const std::array<std::uint8_t, kBaselineBytes>& bytes);

/// The transmitted length of cargo of type 0: 0, 1, 2, 4 or a multiple of 8 up to 480. Empty: it is
/// too long.
std::optional<std::size_t> PaddedCargo(std::size_t bytes);
/// @param data its cargo_bytes are one of PaddedCargo for type 0, and at most 255 for type 1
std::uint64_t EncodeReference(int app_type, const ReferenceData& data);
ReferenceData DecodeReference(int app_type, std::uint64_t app_data);

/// x^8 + x^2 + x + 1, from 0.
std::uint8_t Crc8(const std::uint8_t* bytes, std::size_t size);
/// x^16 + x^15 + x^2 + 1, lowest bits first, from 0: it stands behind the cargo of type 1.
std::uint16_t Crc16(const std::string& bytes);

}  // namespace stg::acoustics::janus

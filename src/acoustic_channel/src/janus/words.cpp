#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "acoustic_channel/engine/text.hpp"
#include "acoustic_channel/janus/janus_modem.hpp"

/// Conversions between words of hosts and packets.
namespace stg::acoustics::janus {
namespace {

constexpr std::size_t kLongestCargo = 480;
constexpr std::size_t kLongestAddressed = 255;  ///< of type 1, including its checksum
constexpr std::array<const char*, 15> kNames = {
    "ack",    "cargo",   "class", "data",    "destination", "forward", "mobility", "packet",
    "repeat", "reserve", "set",   "station", "text",        "tx-rx",   "type"};

bool Known(const std::string& name) {
  for (const char* known : kNames) {
    if (name == known) return true;
  }
  return false;
}

std::string Bit(const char* name, bool value) {
  return std::string(" ") + name + (value ? "=1" : "=0");
}
std::string Whole(const char* name, long long value) {
  return std::string(" ") + name + "=" + std::to_string(value);
}

constexpr std::size_t kChecksumBytes = 2;

void AddChecksum(std::string* cargo) {
  const unsigned crc = Crc16(*cargo);
  *cargo += static_cast<char>(crc >> 8);
  *cargo += static_cast<char>(crc & 0xff);
}

/// True for types of class 16 that state the length of their cargo.
bool TellsCargo(const Packet& p) {
  return p.class_id == kReferenceClass && (p.app_type == 0 || p.app_type == 1);
}

}  // namespace

JanusModem::Words JanusModem::WordsOf(const std::string& line) {
  Words words;
  std::size_t at = 0;
  while ((at = line.find_first_not_of(' ', at)) != std::string::npos) {
    const std::size_t equal = line.find('=', at);
    std::size_t end = std::min(line.find(' ', at), line.size());
    if (equal == std::string::npos || equal > end) throw Refusal{"a word without ="};
    const std::string name = line.substr(at, equal - at);
    if (!Known(name)) throw Refusal{"unknown word"};
    if (name == "text") end = line.size();  // it may have blanks, so it must be the last one
    if (!words.emplace(name, line.substr(equal + 1, end - equal - 1)).second) {
      throw Refusal{name + " twice"};
    }
    at = end;
  }
  return words;
}

Packet JanusModem::PacketOf(const Words& words) const {
  const auto has = [&](const char* name) { return words.count(name) > 0; };
  const auto number = [&](const char* name, int most, int otherwise) {
    if (!has(name)) return otherwise;
    const auto value = NumberIn(words.at(name), 0, most);
    if (!value) throw Refusal{std::string(name) + " must be 0 to " + std::to_string(most)};
    return *value;
  };
  if (has("cargo") && has("text")) throw Refusal{"cargo and text cannot be combined"};
  std::string cargo;
  if (has("text")) cargo = words.at("text");
  if (has("cargo")) {
    const auto bytes = FromHex(words.at("cargo"));
    if (!bytes) throw Refusal{"cargo must be pairs of hexadecimal digits"};
    cargo = *bytes;
  }
  if (has("packet")) {
    if (words.size() > (cargo.empty() ? 1u : 2u))
      throw Refusal{"packet can be combined with cargo only"};
    const auto bytes = FromHex(words.at("packet"));
    if (!bytes || bytes->size() != kBaselineBytes)
      throw Refusal{"packet must be 16 hexadecimal digits"};
    std::array<std::uint8_t, kBaselineBytes> baseline{};
    std::copy(bytes->begin(), bytes->end(), baseline.begin());
    auto packet = Decode(baseline);
    if (!packet) throw Refusal{"packet with a wrong checksum or version"};
    const std::size_t stated =
        TellsCargo(*packet) ? DecodeReference(packet->app_type, packet->app_data).cargo_bytes : 0;
    // Two bytes fewer than stated: the checksum is missing.
    if (packet->app_type == 1 && stated == cargo.size() + kChecksumBytes) AddChecksum(&cargo);
    if (stated != cargo.size()) throw Refusal{"packet states another length of cargo"};
    packet->cargo = cargo;
    return *packet;
  }
  Packet p;
  p.mobility = number("mobility", 1, 0) != 0;
  p.tx_rx = number("tx-rx", 1, 1) != 0;
  p.forward = number("forward", 1, 0) != 0;
  p.class_id = number("class", 255, kReferenceClass);
  p.app_type = number("type", 63, 0);
  p.cargo = cargo;
  SetSchedule(words, &p);
  if (has("data")) {
    std::string digits = words.at("data");
    if (digits.rfind("0x", 0) == 0) digits.erase(0, 2);
    const char* end = digits.data() + digits.size();
    const auto read = std::from_chars(digits.data(), end, p.app_data, 16);
    const bool fits =
        read.ec == std::errc() && read.ptr == end && p.app_data >> p.app_data_bits() == 0;
    if (!fits) throw Refusal{"data must fit into " + std::to_string(p.app_data_bits()) + " bits"};
  }
  SetReference(words, &p);
  const double cargo_s = kCargoByte_s * static_cast<double>(p.cargo.size() + 1);
  const bool reserves = p.schedule == Packet::Schedule::kReservation && !p.cargo.empty();
  if (reserves && ScheduleS(p.schedule, p.schedule_index) < cargo_s) {
    throw Refusal{"the reservation does not cover the cargo"};
  }
  return p;
}

void JanusModem::SetReference(const Words& words, Packet* p) const {
  const auto number = [&](const char* name, int most, int otherwise) {
    const auto found = words.find(name);
    if (found == words.end()) return otherwise;
    const auto value = NumberIn(found->second, 0, most);
    if (!value) throw Refusal{std::string(name) + " must be 0 to " + std::to_string(most)};
    if (words.count("data") > 0)
      throw Refusal{std::string(name) + " is part of data: give one of the two"};
    const bool of_type_0 = std::string(name) == "set";
    const bool of_type_1 = !of_type_0 && std::string(name) != "station";
    if (!TellsCargo(*p) || (of_type_0 && p->app_type != 0) || (of_type_1 && p->app_type != 1)) {
      throw Refusal{std::string(name) + " does not belong to this class and type"};
    }
    return *value;
  };
  ReferenceData d;
  d.station = number("station", 255, options_.station);
  d.parameter_set = number("set", 4095, 0);
  d.destination = number("destination", 255, kToAllStations);
  d.ack_request = number("ack", 1, 0) != 0;
  if (!TellsCargo(*p)) {
    if (!p->cargo.empty())
      throw Refusal{"cargo needs class 16 and type 0 or 1, which state its length"};
    return;
  }
  if (words.count("data") > 0) {
    if (DecodeReference(p->app_type, p->app_data).cargo_bytes != p->cargo.size()) {
      throw Refusal{"data states another length of cargo"};
    }
    return;
  }
  if (p->app_type == 0) {
    const auto padded = PaddedCargo(p->cargo.size());
    if (!padded) throw Refusal{"cargo is longer than " + std::to_string(kLongestCargo)};
    p->cargo.resize(*padded, '\0');
  } else if (!p->cargo.empty()) {
    AddChecksum(&p->cargo);
    if (p->cargo.size() > kLongestAddressed) throw Refusal{"cargo is longer than 253"};
  }
  d.cargo_bytes = p->cargo.size();
  p->app_data = EncodeReference(p->app_type, d);
  if (p->app_data >> p->app_data_bits() != 0)
    throw Refusal{"a schedule leaves no bits for this data"};
}

void JanusModem::SetSchedule(const Words& words, Packet* p) {
  const auto reserve = words.find("reserve"), repeat = words.find("repeat");
  if (reserve == words.end() && repeat == words.end()) return;
  if (reserve != words.end() && repeat != words.end())
    throw Refusal{"reserve and repeat cannot be combined"};
  p->schedule = reserve != words.end() ? Packet::Schedule::kReservation : Packet::Schedule::kRepeat;
  const std::string& text = reserve != words.end() ? reserve->second : repeat->second;
  double time_s = 0.0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), time_s);
  const bool whole = read.ec == std::errc() && read.ptr == text.data() + text.size();
  const auto index = whole ? ScheduleIndex(p->schedule, time_s) : std::nullopt;
  if (!index) throw Refusal{"the standard has no such time of a schedule"};
  p->schedule_index = *index;
}

std::string JanusModem::Tell(const Packet& p) {
  char data[32];
  std::snprintf(data, sizeof(data), " data=0x%0*llX", p.app_data_bits() == 34 ? 9 : 7,
                static_cast<unsigned long long>(p.app_data));
  std::string line = Whole("class", p.class_id) + Whole("type", p.app_type) +
                     Bit("mobility", p.mobility) + Bit("tx-rx", p.tx_rx) +
                     Bit("forward", p.forward);
  if (p.schedule != Packet::Schedule::kNone) {
    char time[64];
    std::snprintf(time, sizeof(time), " %s=%.6g",
                  p.schedule == Packet::Schedule::kRepeat ? "repeat" : "reserve",
                  ScheduleS(p.schedule, p.schedule_index));
    line += time;
  }
  line += data;
  if (!TellsCargo(p)) return line;
  const ReferenceData d = DecodeReference(p.app_type, p.app_data);
  line += Whole("station", d.station);
  if (p.app_type == 0) {
    line += Whole("set", d.parameter_set);
    return p.cargo.empty() ? line : line + " cargo=" + ToHex(p.cargo);
  }
  line += Whole("destination", d.destination) + Bit("ack", d.ack_request);
  if (p.cargo.size() < kChecksumBytes) return line;
  std::string bytes = p.cargo.substr(0, p.cargo.size() - kChecksumBytes);
  line += " cargo=" + ToHex(bytes);
  AddChecksum(&bytes);
  return line + (bytes == p.cargo ? " crc=ok" : " crc=bad");
}

}  // namespace stg::acoustics::janus

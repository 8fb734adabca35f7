#include <cstdio>
#include <ctime>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/micromodem/micromodem.hpp"

/// Commands of hosts: settings, clock, and data to send.
namespace stg::acoustics::micromodem {
namespace {

constexpr int kHighestAddress = 127;
constexpr int kLargestMini = 0x1fff;  ///< 13 bits

using Fields = std::vector<std::string>;

/// Numbers of the fields from `first` on, each within its limit. Nothing if one of them is not.
std::optional<std::vector<int>> Numbers(const Fields& fields, const std::vector<int>& limits) {
  if (fields.size() != limits.size() + 1) return {};
  std::vector<int> numbers;
  for (std::size_t k = 0; k < limits.size(); ++k) {
    const auto number = NumberIn(fields[k + 1], 0, limits[k]);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

/// UTC of a calendar date [ns since 1970]. Nothing if there is no such date.
std::optional<TimeNs> UtcOf(int year, int month, int day, int hour, int minute, double second) {
  const bool fits = year >= 1970 && year <= 2200 && month >= 1 && month <= 12 && day >= 1 &&
                    day <= 31 && hour >= 0 && hour <= 23 && minute >= 0 && minute <= 59 &&
                    second >= 0.0 && second < 61.0;
  if (!fits) return {};
  std::tm parts{};
  parts.tm_year = year - 1900;
  parts.tm_mon = month - 1;
  parts.tm_mday = day;
  parts.tm_hour = hour;
  parts.tm_min = minute;
  return static_cast<TimeNs>(timegm(&parts)) * kSecondNs + static_cast<TimeNs>(second * 1e9);
}

}  // namespace

void Micromodem::SetDefaults() {
  settings_ = {{"ASD", "0"}, {"BND", "3"},  {"BW0", "5000"},  {"CST", "1"}, {"CTO", "10"},
               {"DQF", "1"}, {"DTO", "10"}, {"FC0", "25000"}, {"MOD", "0"}, {"PTO", "14"},
               {"REV", "1"}, {"RXA", "1"},  {"RXD", "1"},     {"RXP", "1"}, {"SNV", "0"},
               {"TOA", "0"}, {"XST", "1"}};
  settings_["TAT"] = std::to_string(kDefaultTurnaroundMs);
  settings_["SRC"] = std::to_string(options_.address);
}

void Micromodem::Obey(const Sentence& sentence, TimeNs t) {
  if (!sentence.error.empty()) return Error(t, "NMEA", 1, sentence.error);
  const std::string& name = sentence.fields[0];
  if (name.rfind("CC", 0) != 0) return Error(t, "NMEA", 2, "unknown sentence");
  const bool known = ObeySetting(sentence.fields, t) || ObeyClock(sentence.fields, t) ||
                     ObeySending(sentence.fields, t);
  if (!known) Error(t, "NMEA", 2, "unknown sentence");
}

bool Micromodem::ObeySetting(const Fields& fields, TimeNs t) {
  const std::string& name = fields[0];
  if (name == "CCCFG") {
    if (fields.size() != 3 || fields[1].empty()) {
      Error(t, "NMEA", 3, "CCCFG needs a key and a value");
    } else if (fields[1] == "ALL" && fields[2] == "0") {
      SetDefaults();
      world_->SetAddress(setting("SRC"));
      Say({"CACFG", "ALL", "0"});
    } else if (fields[1] == "SRC" && !NumberIn(fields[2], 1, kHighestAddress)) {
      Error(t, "NMEA", 4, "SRC must be 1 to 127");
    } else if (settings_.size() >= 200 && settings_.count(fields[1]) == 0) {
      Error(t, "NMEA", 5, "too many settings");
    } else {
      settings_[fields[1]] = fields[2];
      if (fields[1] == "SRC") world_->SetAddress(setting("SRC"));
      Say({"CACFG", fields[1], fields[2]});
    }
    return true;
  }
  if (name == "CCCFQ") {
    const std::string key = fields.size() == 2 ? fields[1] : "";
    if (key == "ALL" || key == "TOP") {
      for (const auto& [each, value] : settings_) Say({"CACFG", each, value});
    } else if (settings_.count(key) == 0) {
      Error(t, "NMEA", 4, "no such setting");
    } else {
      Say({"CACFG", key, settings_[key]});
    }
    return true;
  }
  if (name == "CCMSC" || name == "CCRST") {
    Fields echo = fields;
    echo[0][1] = 'A';
    Say(echo);
    Reboot(t);
    return true;
  }
  return false;
}

bool Micromodem::ObeyClock(const Fields& fields, TimeNs t) {
  const std::string& name = fields[0];
  if (name == "CCCLK") {
    const auto n = Numbers(fields, {2200, 12, 31, 23, 59, 60});
    const auto utc = n ? UtcOf((*n)[0], (*n)[1], (*n)[2], (*n)[3], (*n)[4], (*n)[5]) : std::nullopt;
    if (SetClock(utc, options_.pps, t)) {
      // With a tick, the clock will show this time at the next tick. Goby waits for a second before
      // it compares this time with its own.
      const TimeNs time = utc.value_or(0);
      Say({"CACLK", FormatUtc(time, "%Y,%m,%d,%H,%M,%S")});
    }
    return true;
  }
  if (name == "CCCLQ") {
    Say({"CACLK", FormatUtc(Utc(t), "%Y,%m,%d,%H,%M,%S")});
    return true;
  }
  if (!second_generation()) return false;
  if (name == "CCTMS") {
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, end = 0;
    double second = 0.0;
    const std::string text = fields.size() == 3 ? fields[1] : "";
    const int read = std::sscanf(text.c_str(), "%4d-%2d-%2dT%2d:%2d:%12lfZ%n", &year, &month, &day,
                                 &hour, &minute, &second, &end);
    const bool whole = read == 6 && static_cast<std::size_t>(end) == text.size();
    const auto mode = fields.size() == 3 ? NumberIn(fields[2], 0, 1) : std::nullopt;
    const auto utc = whole ? UtcOf(year, month, day, hour, minute, second) : std::nullopt;
    if (!mode) {
      Error(t, "NMEA", 3, "CCTMS needs a time and the mode 0 or 1");
    } else if (SetClock(utc, options_.pps || *mode == 1, t)) {
      const TimeNs time = utc.value_or(0);
      Say({"CATMS", "0", FormatUtc(time, "%Y-%m-%dT%H:%M:%SZ")});
    }
    return true;
  }
  if (name == "CCTMQ") {
    Say({"CATMQ", FormatUtc(Utc(t), "%Y-%m-%dT%H:%M:%SZ"), clock_set_ ? "USER_CMD" : "NONE",
         pps_ ? "EXT" : "NONE"});
    return true;
  }
  return false;
}

/// Without a tick, the clock shows `utc` now. With a tick, the clock shows `utc` at the next tick,
/// and does not drift from then on, whatever the vehicle's own clock does.
/// @return false if the time is not valid
bool Micromodem::SetClock(const std::optional<TimeNs>& utc, bool pps, TimeNs t) {
  if (!utc) {
    Error(t, "NMEA", 4, "not a valid time");
    return false;
  }
  pps_ = pps;
  clock_set_ = true;
  if (pps) {
    const TimeNs now = world_->utc_start() + t;
    const TimeNs tick = now - now % kSecondNs + kSecondNs;
    clock_offset_ = *utc - *utc % kSecondNs - tick;
  } else {
    clock_offset_ += *utc - Utc(t);
  }
  return true;
}

bool Micromodem::ObeySending(const Fields& fields, TimeNs t) {
  const std::string& name = fields[0];
  if (name == "CCTXD" || name == "CCTXA") return CommandFrame(fields, name == "CCTXA", t);
  const bool sends = name == "CCCYC" || name == "CCMPC" || name == "CCMUC" || name == "CCPDT" ||
                     name == "CCPNT" || (name == "CCTDP" && second_generation());
  if (!sends) return false;
  if (state_ != State::kIdle) {
    Error(t, "BUSY", 6, "busy with another command");
    return true;
  }
  bool sound = false;
  if (name == "CCCYC") sound = CommandCycle(fields, t);
  if (name == "CCMPC") sound = CommandPing(fields, t);
  if (name == "CCMUC") sound = CommandMini(fields, t);
  if (name == "CCPDT" || name == "CCPNT") sound = CommandLbl(fields, t);
  if (name == "CCTDP") sound = CommandFlexible(fields, t);
  if (!sound) Error(t, "NMEA", 3, name + " with invalid fields");
  return true;
}

bool Micromodem::CommandCycle(const Fields& fields, TimeNs t) {
  const auto n = Numbers(fields, {15, kHighestAddress, kHighestAddress, kRates - 1, 1, 8});
  if (!n) return false;
  PacketHeader h;
  h.type = PacketType::kCycle;
  h.poller_command = (*n)[0];
  h.source = (*n)[1];
  h.destination = (*n)[2];
  h.rate = (*n)[3];
  h.acks = (*n)[4] != 0 ? 0xff : 0;
  h.frames = (*n)[5];
  const bool asks_itself = h.source == h.destination;
  if (asks_itself || h.source == options_.broadcast || h.frames < 1 ||
      static_cast<std::size_t>(h.frames) > modes_.rate(h.rate).max_frames) {
    return false;
  }
  Fields echo = fields;
  echo[0] = "CACYC";
  Say(echo);
  cycle_ = {};
  cycle_.header = h;
  cycle_.wanted = h.frames;
  if (h.source == setting("SRC") && h.rate != 0) {
    AskForFrame(t);
  } else {
    Enter(State::kCycleTx, t + kSendingTimeout);
    Transmit(h, std::string(1, '\0'), 0, t);
  }
  return true;
}

bool Micromodem::CommandFrame(const Fields& fields, bool text, TimeNs t) {
  const std::string& name = fields[0];
  if (state_ != State::kDataRequest) {
    Error(t, "DATA", 7, "no request for data");
    return true;
  }
  const auto refuse = [&](const std::string& why) {
    Error(t, "NMEA", 3, name + ": " + why);
    return true;
  };
  if (fields.size() < 5 || (!text && fields.size() != 5)) return refuse("wrong number of fields");
  const auto source = NumberIn(fields[1], 0, kHighestAddress);
  const auto destination = NumberIn(fields[2], 0, kHighestAddress);
  const auto ack = NumberIn(fields[3], 0, 1);
  if (!source || !destination || !ack) return refuse("a field is invalid");
  if (*destination == setting("SRC")) return refuse("to itself");
  std::optional<std::string> bytes;
  if (text) {
    bytes = Join(Fields(fields.begin() + 4, fields.end()));  // a text may contain commas
  } else {
    bytes = FromHex(fields[4]);
  }
  const std::size_t most = modes_.rate(cycle_.header.rate).frame_bytes;
  if (!bytes) return refuse("not pairs of hexadecimal digits");
  if (bytes->size() > most) return refuse("more bytes than a frame holds");
  Say({text ? "CATXA" : "CATXD", fields[1], fields[2], fields[3], std::to_string(bytes->size())});
  if (bytes->empty()) {
    SendFrames(t);
    return true;
  }
  PacketHeader& h = cycle_.header;
  if (cycle_.frames.empty()) h.acks = 0;  // from here on it counts by frame
  h.source = setting("SRC");
  h.destination = *destination;
  h.text = text;
  const bool acknowledged = *ack != 0 && *destination != options_.broadcast;
  if (acknowledged) h.acks |= 1u << cycle_.frames.size();
  cycle_.frames.push_back(*bytes);
  if (static_cast<int>(cycle_.frames.size()) < cycle_.wanted) {
    AskForFrame(t);
  } else {
    SendFrames(t);
  }
  return true;
}

bool Micromodem::CommandPing(const Fields& fields, TimeNs t) {
  const auto n = Numbers(fields, {kHighestAddress, kHighestAddress});
  if (!n || (*n)[1] == setting("SRC") || (*n)[1] == options_.broadcast) return false;
  Say({"CAMPC", fields[1], fields[2]});
  PacketHeader h;
  h.type = PacketType::kPing;
  h.source = setting("SRC");
  h.destination = (*n)[1];
  ping_ = {};
  ping_.open = true;
  ping_.destination = h.destination;
  Enter(State::kPacketTx, t + kSendingTimeout);
  Transmit(h, std::string(1, '\0'), 0, t);
  return true;
}

bool Micromodem::CommandMini(const Fields& fields, TimeNs t) {
  if (fields.size() != 4 || fields[3].size() > 4) return false;
  const auto destination = NumberIn(fields[2], 0, kHighestAddress);
  const auto bytes = FromHex(std::string(4 - fields[3].size(), '0') + fields[3]);
  if (!NumberIn(fields[1], 0, kHighestAddress) || !destination || !bytes || fields[3].empty() ||
      *destination == setting("SRC")) {
    return false;
  }
  const int value =
      static_cast<unsigned char>((*bytes)[0]) * 256 + static_cast<unsigned char>((*bytes)[1]);
  if (value > kLargestMini) return false;
  Say({"CAMUC", fields[1], fields[2], fields[3]});
  PacketHeader h;
  h.type = PacketType::kMini;
  h.source = setting("SRC");
  h.destination = *destination;
  Enter(State::kPacketTx, t + kSendingTimeout);
  Transmit(h, *bytes, 0, t);
  return true;
}

bool Micromodem::CommandFlexible(const Fields& fields, TimeNs t) {
  if (fields.size() != 6) return false;
  const auto destination = NumberIn(fields[1], 0, kHighestAddress);
  const auto rate = NumberIn(fields[2], 1, kRates - 1);
  const auto ack = NumberIn(fields[3], 0, 1);
  const auto bytes = FromHex(fields[5]);
  if (!destination || !rate || !ack || !bytes || bytes->empty() || *destination == setting("SRC") ||
      bytes->size() > modes_.rate(*rate).max_payload()) {
    return false;
  }
  flexible_id_ = flexible_id_ % 255 + 1;
  Say({"CATDP", "0", std::to_string(flexible_id_), fields[1], fields[2], fields[3], "0"});
  PacketHeader h;
  h.type = PacketType::kFlexible;
  h.source = setting("SRC");
  h.destination = *destination;
  h.rate = *rate;
  h.frames = 1;
  h.frame_bytes = static_cast<int>(bytes->size());
  h.acks = *ack != 0 && *destination != options_.broadcast ? 1 : 0;
  Enter(State::kPacketTx, t + kSendingTimeout);
  Transmit(h, *bytes, bytes->size(), t);
  return true;
}

}  // namespace stg::acoustics::micromodem

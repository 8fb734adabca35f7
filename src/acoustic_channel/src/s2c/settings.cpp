#include "acoustic_channel/s2c/settings.hpp"

#include <array>

#include "acoustic_channel/s2c/reader.hpp"

namespace stg::acoustics::s2c {
namespace {

struct Known {
  const char* name;
  int factory, lo, hi;
  const char* shown;  ///< name in AT&V; null: not listed there
};

/// First the settings that change the behaviour of the emulated modem, then those that it only
/// stores and shows.
constexpr std::array<Known, 26> kKnown{{
    {"L", 0, 0, 3, "Source Level"},
    {"LC", 0, 0, 1, "Source Level Control"},
    {"G", 1, 0, 1, "Gain"},
    {"AL", 1, 1, 254, "Local Address"},
    {"AM", 254, 2, 254, "Highest Address"},
    {"AR", 0, 0, 254, "Remote Address"},
    {"RI", 1, 0, 255, "IM Retry"},
    {"RT", 5000, 500, 12000, "Retry Timeout"},
    {"RP", 0, 0, 1, "Promiscuous Mode"},
    {"PID", 0, 0, 255, "Protocol ID"},
    {"C", 0, 0, 255, "Cluster Size"},
    {"RC", 3, 0, 255, "Retry Count"},
    {"ZC", 0, 0, 255, nullptr},
    {"ZP", 0, 0, 65535, nullptr},
    {"KO", 0, 0, 3600, "Idle Timeout"},
    {"ZI", 0, 0, 65535, nullptr},
    {"ZS", 0, 0, 65535, nullptr},
    {"UT", 0, 0, 65535, nullptr},
    {"WU", 0, 0, 65535, "Wake Up Active Time"},
    {"CA", 1500, 1300, 1700, "Sound Speed"},
    {"ZX", 0, 0, 1, "Extended Notifications"},
    {"ZF", 0, 0, 1, "Protocol ID Fields"},
    {"ZU", 0, 0, 1, nullptr},
    {"ZA", 0, 0, 1, nullptr},
    {"PT", 0, 0, 255, "Pool Type"},
    {"PS", 16384, 0, 1048576, "Pool Size"},
}};

/// AT@ZX and similar settings last until the power is switched off. They are never stored and never
/// marked.
bool OfSession(const std::string& name) {
  return name == "ZX" || name == "ZF" || name == "ZU" || name == "ZA";
}

}  // namespace

double SourceLevelDb(int level) {
  constexpr std::array<double, 4> kLevels{0.0, -6.0, -12.0, -20.0};
  return kLevels.at(static_cast<std::size_t>(level));
}

Settings::Settings() {
  for (const Known& k : kKnown) values_[k.name] = {k.factory, k.factory, k.factory, k.lo, k.hi};
}

Settings::Result Settings::Set(const std::string& name, const std::string& text) {
  const auto found = values_.find(name);
  if (found == values_.end()) return Result::kUnknown;
  const auto number = WholeNumber(text);
  if (!number) return Result::kNoNumber;
  Value& v = found->second;
  if (*number < static_cast<unsigned>(v.lo) || *number > static_cast<unsigned>(v.hi)) {
    return Result::kOutOfRange;
  }
  const int value = static_cast<int>(*number);
  if (name == "AM" && ((value + 2) & (value + 1)) != 0) return Result::kOutOfRange;
  if (name == "AL" && value > at("AM")) return Result::kOutOfRange;
  v.now = value;
  return Result::kOk;
}

int Settings::at(const std::string& name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? 0 : found->second.now;
}

void Settings::Store() {
  for (auto& [name, v] : values_) {
    if (!OfSession(name)) v.stored = v.now;
  }
}
void Settings::Restore() {
  for (auto& [name, v] : values_) v.now = v.stored;
}
void Settings::RestoreFactory() {
  for (auto& [name, v] : values_) v.now = v.factory;
}

bool Settings::changed(const std::string& name) const {
  const auto found = values_.find(name);
  return found != values_.end() && !OfSession(name) && found->second.now != found->second.stored;
}

std::string Settings::List() const {
  std::string text;
  for (const Known& k : kKnown) {
    if (k.shown == nullptr) continue;
    text += std::string(k.shown) + ": " + (changed(k.name) ? "[*]" : "") +
            std::to_string(at(k.name)) + "\n";
  }
  return text;
}

}  // namespace stg::acoustics::s2c

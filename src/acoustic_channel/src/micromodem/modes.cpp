#include "acoustic_channel/micromodem/modes.hpp"

#include <string>

namespace stg::acoustics::micromodem {
namespace {

constexpr char kPskWaveform[] = "micromodem_psk";

}  // namespace

Modes::Modes(const ModemProfile& own) {
  const auto at_own_frequency = [&](const std::string& name) {
    ModemProfile mode = *ModemProfiles().Make(name);
    mode.centre_khz = own.centre_khz;
    mode.source_level_db = own.source_level_db;
    return mode;
  };
  for (int rate = 0; rate < kRates; ++rate) {
    const std::string family = rate == 0 ? "micromodem_fsk_r" : "micromodem_psk_r";
    rates_[static_cast<std::size_t>(rate)] = at_own_frequency(family + std::to_string(rate));
  }
  mini_ = mini_psk_ = at_own_frequency("micromodem_mini");
  // Nothing is published about mini-packets in PSK. They are assumed to take as long and to be lost
  // as often.
  mini_psk_.waveform = kPskWaveform;
  mini_psk_.name += "_psk";
  // A ping has no content: it is heard where the modem acquires it.
  lbl_ = mini_;
  lbl_.name = lbl_.waveform = "micromodem_lbl";
  lbl_.frame_s = 0.001;
  lbl_.frame_bytes = 1;
  lbl_.max_frames = 1000;
  lbl_.spreading_db = 0.0;
  lbl_.errors = {};
  lbl_.errors.kind = ErrorCurve::Kind::kNone;
}

bool IsPsk(const ModemProfile* profile) {
  return profile != nullptr && profile->waveform == kPskWaveform;
}

int RateOf(const ModemProfile& profile) {
  const std::string& name = profile.name;
  if (name.rfind("micromodem_", 0) != 0 || name.size() < 2) return -1;
  const char digit = name.back();
  const bool rated = name[name.size() - 2] == 'r' && digit >= '0' && digit < '0' + kRates;
  return rated ? digit - '0' : -1;
}

}  // namespace stg::acoustics::micromodem

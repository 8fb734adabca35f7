#pragma once

#include <array>

#include "acoustic_channel/modem/modem_profile.hpp"

namespace stg::acoustics::micromodem {

inline constexpr int kRates = 7;  ///< 0 to 6

/// Modes of a Micromodem, all at the centre frequency of its own profile.
class Modes {
 public:
  explicit Modes(const ModemProfile& own);

  const ModemProfile& rate(int rate) const { return rates_[static_cast<std::size_t>(rate)]; }
  /// A mini-packet, in FSK or PSK.
  const ModemProfile& mini(bool psk = false) const { return psk ? mini_psk_ : mini_; }
  /// A sound of LBL ranging; it takes a millisecond a byte.
  const ModemProfile& lbl() const { return lbl_; }

 private:
  std::array<ModemProfile, kRates> rates_;
  ModemProfile mini_, mini_psk_, lbl_;
};

/// True for a profile with PSK; false for FSK, and for no profile (null).
bool IsPsk(const ModemProfile* profile);
/// The rate of a Micromodem's profile; -1 for the profile of any other modem.
int RateOf(const ModemProfile& profile);

}  // namespace stg::acoustics::micromodem

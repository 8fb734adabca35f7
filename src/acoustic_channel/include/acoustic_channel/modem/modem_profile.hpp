#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "acoustic_channel/modem/error_rate.hpp"
#include "acoustic_channel/modem/modem_config.hpp"
#include "auv_common/registry.hpp"
#include "auv_common/time.hpp"

/// Modems as data.
namespace stg::acoustics {

/// Data of a modem for the network. Levels in dB re 1 uPa at 1 m.
struct ModemProfile {
  std::string name;
  std::string waveform;  ///< modems of the same one understand each other; others are noise
  bool ideal = false;    ///< instant and lossless in any water; other fields are unused

  double centre_khz = 0.0, bandwidth_khz = 0.0;
  double source_level_db = 0.0;

  /// A packet is a preamble and whole frames of `frame_bytes` each.
  double preamble_s = 0.0, frame_s = 0.0;
  std::size_t frame_bytes = 1, max_frames = 1;

  double acquisition_db = 0.0;     ///< ratio in the band at which a receiver locks on
  double implementation_db = 0.0;  ///< loss of a real receiver against its error curve
  ErrorCurve errors;
  /// Bandwidth over bit rate [dB]. Despreading raises a packet above the noise by this ratio. It
  /// raises other packets of the same waveform by the same ratio, so their power counts this much
  /// more than noise.
  double spreading_db = 0.0;

  double turnaround_s = 0.0;  ///< from the end of a reception or transmission to the next start
  double transmit_w = 0.0, receive_w = 0.0, idle_w = 0.0;  ///< electric

  std::size_t max_payload() const { return frame_bytes * max_frames; }
  std::size_t frames(std::size_t bytes) const { return (bytes + frame_bytes - 1) / frame_bytes; }
  double airtime_s(std::size_t bytes) const {
    return ideal ? 0.0 : preamble_s + static_cast<double>(frames(bytes)) * frame_s;
  }
  /// The same in whole nanoseconds, as the network counts.
  TimeNs airtime(std::size_t bytes) const;
  TimeNs turnaround() const;
};

/// All profiles, by the name that `channel.physical.modem.profile` takes. To add a profile with
/// options of its own, write a new file and one line in src/modem/modem_profile.cpp; another
/// program calls Add before it loads a configuration.
using ModemProfileRegistry = Registry<ModemProfile>;
ModemProfileRegistry& ModemProfiles();

/// The profile of every node, as the section says. Throws UserError for a name that no profile has
/// or a list that is not as long as the fleet.
std::vector<ModemProfile> MakeProfiles(const ModemConfig& config, int nodes);

/// Why the section cannot work for so many nodes; empty: it can.
std::optional<config::Violation> FindConflict(const ModemConfig& c, int nodes);

/// Longest payload of the network: the section's, or the longest one of every modem [bytes].
std::size_t LongestPayload(const ModemConfig& config, int nodes);

/// Longest time that a packet of the network takes to leave a modem of the fleet, and the longest
/// time that one of them needs between two packets. For rules that give each modem a slot.
TimeNs LongestAirtime(const ModemConfig& config, int nodes);
TimeNs LongestTurnaround(const ModemConfig& config, int nodes);

}  // namespace stg::acoustics

#pragma once

#include <cstdint>

#include "acoustic_channel/modem/modem_profile.hpp"
#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"

/// Interface of the water for a network of modems.
namespace stg::acoustics {

/// A node at some time; world axes.
struct NodeMotion {
  Vec3<double> p_W, v_W;  ///< [m], [m/s]
};

/// A packet on its way from one node to another.
struct PacketKey {
  int source = 0, receiver = 0;
  std::uint32_t sequence = 0;
  TimeNs transmit = 0;
};

/// A packet at a receiver. Levels are in dB re 1 uPa in the sender's band.
struct Hearing {
  double distance_m = 0.0, travel_time_s = 0.0;
  double level_db = 0.0;         ///< with all draws
  double steady_level_db = 0.0;  ///< without the draws of fading
  double clear_level_db = 0.0;   ///< also without the loss of a blocked line
};

/// Noise at a receiver in its band, constant until `until`.
struct NoiseSpan {
  double level_db = 0.0;
  double quiet_level_db = 0.0;  ///< without a burst
  TimeNs until = 0;
};

/// Sound and noise. Draws depend on seed, episode and the arguments only. Hear is called in the
/// order of transmission times.
class Medium {
 public:
  virtual ~Medium() = default;
  virtual void Reset(std::uint64_t seed, std::uint32_t episode) = 0;

  virtual Hearing Hear(const PacketKey& key, const NodeMotion& source, const NodeMotion& receiver,
                       const ModemProfile& sender) = 0;
  virtual NoiseSpan Noise(int node, TimeNs t, double speed_mps, const ModemProfile& receiver) = 0;
  /// Expected values of a link, without draws.
  virtual Hearing Expect(const NodeMotion& source, const NodeMotion& receiver,
                         const ModemProfile& sender) const = 0;
  /// [m/s], for ranging.
  virtual double SoundSpeed(const Vec3<double>& p_W) const = 0;
};

}  // namespace stg::acoustics

#pragma once

#include <array>
#include <cstdint>

#include "auv_common/numbers/vector.hpp"
#include "auv_dynamics/world/surroundings_config.hpp"

namespace stg::dynamics {

/// Water current over depth and time: a constant, plus layers that are linear between four depths
/// and constant above and below, plus a tide, amplitude cos(2 pi t / period + phase), plus layers
/// and a tide like these that are drawn per episode. Horizontal
/// but for the constant. A vehicle takes the current at its origin for that of its whole hull, and
/// as steady and irrotational during a physics step.
class Current {
 public:
  explicit Current(const CurrentConfig& config);

  /// Draws what is drawn per episode, in one lane.
  void Reset(int lane, std::uint64_t seed, std::uint32_t episode);

  /// The same everywhere and always.
  bool uniform() const { return uniform_; }
  /// @param z      height in the world [m], negative below the surface
  /// @param time_s since the start of the episode [s]
  /// @return velocity, world axes [m/s]
  Vec3<Pack> At(const Pack& z, const Pack& time_s) const;

 private:
  CurrentConfig config_;
  bool layered_, tidal_, uniform_;
  // Of current.random_mps.
  std::array<Pack, 4> east_, north_;  // at the layers' depths
  Pack tide_east_ = Pack(0.0), tide_north_ = Pack(0.0), tide_phase_ = Pack(0.0);
};

}  // namespace stg::dynamics

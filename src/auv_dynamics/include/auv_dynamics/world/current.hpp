#pragma once

#include <array>
#include <cstdint>

#include "auv_common/numbers/vector.hpp"
#include "auv_dynamics/world/surroundings_config.hpp"

namespace stg::dynamics {

/// Water current over depth and time: a constant, plus layers that are linear between four depths
/// and constant above and below, plus a tide, amplitude cos(2 pi t / period + phase), plus layers
/// and a tide of the same form that are drawn per episode. All parts except the constant are
/// horizontal. The current at a vehicle's origin acts on its whole hull; during a physics step it
/// is steady and irrotational.
class Current {
 public:
  explicit Current(const CurrentConfig& config);

  /// Draws the random parts of an episode, in one lane.
  void Reset(int lane, std::uint64_t seed, std::uint32_t episode);

  /// Whether the current is constant in space and time.
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

#include "auv_dynamics/world/current.hpp"

#include <algorithm>

#include "auv_common/numbers/attitude.hpp"

namespace stg::dynamics {
namespace {

template <std::size_t N>
bool AnyOf(const std::array<double, N>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return v != 0.0; });
}

}  // namespace

Current::Current(const CurrentConfig& config)
    : config_(config),
      layered_(AnyOf(config.layer_east_mps) || AnyOf(config.layer_north_mps)),
      tidal_(AnyOf(config.tide_mps)),
      uniform_(!layered_ && !tidal_) {}

Vec3<Pack> Current::At(const Pack& z, const Pack& time_s) const {
  const CurrentConfig& c = config_;
  Vec3<Pack> v = Broadcast({c.velocity_mps[0], c.velocity_mps[1], c.velocity_mps[2]});
  if (layered_) {
    Pack east(c.layer_east_mps[0]), north(c.layer_north_mps[0]);
    for (std::size_t k = 1; k < c.layer_depth_m.size(); ++k) {
      const double thickness = c.layer_depth_m[k] - c.layer_depth_m[k - 1];
      const Pack share =
          Clip((-z - Pack(c.layer_depth_m[k - 1])) * Pack(1.0 / thickness), 0.0, 1.0);
      east += share * Pack(c.layer_east_mps[k] - c.layer_east_mps[k - 1]);
      north += share * Pack(c.layer_north_mps[k] - c.layer_north_mps[k - 1]);
    }
    v.x += east;
    v.y += north;
  }
  if (tidal_) {
    Pack sine, cosine;
    SinCos(time_s * Pack(2.0 * kPi / c.tide_period_s) + Pack(c.tide_phase_rad), &sine, &cosine);
    v.x += cosine * Pack(c.tide_mps[0]);
    v.y += cosine * Pack(c.tide_mps[1]);
  }
  return v;
}

}  // namespace stg::dynamics

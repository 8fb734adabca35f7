#include "auv_dynamics/world/current.hpp"

#include <cmath>

#include "auv_common/numbers/attitude.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::dynamics {

Current::Current(const CurrentConfig& config)
    : config_(config),
      layered_(config.layered()),
      tidal_(config.tidal()),
      uniform_(!layered_ && !tidal_ && !config.random()) {
  east_.fill(Pack(0.0));
  north_.fill(Pack(0.0));
}

void Current::Reset(int lane, std::uint64_t seed, std::uint32_t episode) {
  if (!config_.random()) return;
  Random random(seed, Stream::kCurrent, episode, 0, 0);
  double direction = random.Uniform(0.0, 2.0 * kPi);
  for (std::size_t k = 0; k < east_.size(); ++k) {
    if (k > 0) direction += config_.random_turn_deg * kPi / 180.0 * random.Normal();
    const double speed = random.Uniform(config_.random_mps.lo, config_.random_mps.hi);
    SetLane(&east_[k], lane, speed * std::cos(direction));
    SetLane(&north_[k], lane, speed * std::sin(direction));
  }
  const double to = random.Uniform(0.0, 2.0 * kPi);
  SetLane(&tide_east_, lane, config_.random_tide_mps * std::cos(to));
  SetLane(&tide_north_, lane, config_.random_tide_mps * std::sin(to));
  SetLane(&tide_phase_, lane, random.Uniform(0.0, 2.0 * kPi));
}

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
  if (config_.random()) {
    Pack east = east_[0], north = north_[0], sine, cosine;
    for (std::size_t k = 1; k < c.layer_depth_m.size(); ++k) {
      const double thickness = c.layer_depth_m[k] - c.layer_depth_m[k - 1];
      const Pack share =
          Clip((-z - Pack(c.layer_depth_m[k - 1])) * Pack(1.0 / thickness), 0.0, 1.0);
      east += share * (east_[k] - east_[k - 1]);
      north += share * (north_[k] - north_[k - 1]);
    }
    SinCos(time_s * Pack(2.0 * kPi / c.tide_period_s) + tide_phase_, &sine, &cosine);
    v.x += east + cosine * tide_east_;
    v.y += north + cosine * tide_north_;
  }
  return v;
}

}  // namespace stg::dynamics

#include "auv_dynamics/world/disturbance.hpp"

#include <cmath>

namespace stg::dynamics {

Disturbance::Disturbance(const DisturbanceConfig& config, int vehicles, double dt_s)
    : config_(config),
      decay_(std::exp(-dt_s / config.correlation_time_s)),
      drive_(std::sqrt(1.0 - decay_ * decay_)),
      wrenches_(static_cast<size_t>(vehicles)) {}

void Disturbance::Advance(const EpisodeClocks& clocks) {
  if (config_.force_std_n == 0.0 && config_.moment_std_nm == 0.0) return;
  for (size_t i = 0; i < wrenches_.size(); ++i) {
    Wrench<Pack>& w = wrenches_[i];
    for (int lane = 0; lane < kLanes; ++lane) {
      const EpisodeClock& clock = clocks[static_cast<size_t>(lane)];
      Random random = clock.Draw(Stream::kDisturbance, static_cast<std::uint32_t>(i));
      const bool first = clock.step == 0;
      const auto next = [&](Pack* x, double std) {
        const double n = random.Normal() * std;
        SetLane(x, lane, first ? n : decay_ * Lane(*x, lane) + drive_ * n);
      };
      for (Pack* x : {&w.force.x, &w.force.y, &w.force.z}) next(x, config_.force_std_n);
      for (Pack* x : {&w.moment.x, &w.moment.y, &w.moment.z}) next(x, config_.moment_std_nm);
    }
  }
}

}  // namespace stg::dynamics

#include <cmath>

#include "auv_common/numbers/random.hpp"
#include "auv_dynamics/vehicle/vehicle_model.hpp"
#include "auv_dynamics/world/world.hpp"

namespace stg::dynamics {
namespace {

/// Dropouts start in each spell-long slot with the probability of a Poisson
/// process of the given rate and blind the sensor for that slot: memoryless
/// across slots, so that a draw needs no history.
bool Blind(const SensingConfig& c, std::uint64_t seed, std::uint32_t episode, double time,
           std::uint32_t index) {
  if (c.dropout_rate_hz <= 0.0) return false;
  const auto slot = static_cast<std::uint32_t>(time / c.dropout_duration_s);
  Random random(seed, Stream::kDetection, episode, slot, index | 0x800000U);
  return random.Uniform() < 1.0 - std::exp(-c.dropout_rate_hz * c.dropout_duration_s);
}

}  // namespace

bool World::Sense(int lane, int i, int k, Detection* out) const {
  const SensingConfig& c = scenario_.sensing;
  const Vec3<double> p_WB = Lane(vehicle(i).p_WB, lane);
  const Vec3<double> p_WT = Lane(target(k).p_WT, lane);
  if (Norm(p_WT - p_WB) > c.range_m) return false;
  const auto index = static_cast<std::uint32_t>(i * targets() + k);
  out->stamp = time(lane);
  out->target = k;
  out->p_WT = p_WT;
  out->std_m = c.noise_std_m;
  if (c.detection_probability >= 1.0 && c.noise_std_m == 0.0 && c.dropout_rate_hz == 0.0) {
    return true;
  }
  if (Blind(c, seed_[lane], episode_[lane], scenario_.time.dt_s * step_[lane], index)) return false;
  Random random(seed_[lane], Stream::kDetection, episode_[lane], step_[lane], index);
  if (random.Uniform() >= c.detection_probability) return false;
  const double s = c.noise_std_m;
  out->p_WT += Vec3<double>{s * random.Normal(), s * random.Normal(), s * random.Normal()};
  return true;
}

Cue World::InitialCue(int lane, int i, int k) const {
  // Every vehicle is given the same datum: one contact report starts the search.
  (void)i;
  Random random(seed_[lane], Stream::kCue, episode_[lane], 0, static_cast<std::uint32_t>(k));
  const double s = scenario_.sensing.cue_std_m;
  Cue cue;
  cue.target = k;
  cue.std_m = s;
  cue.p_WT = Lane(target(k).p_WT, lane) +
             Vec3<double>{s * random.Normal(), s * random.Normal(), s * random.Normal()};
  return cue;
}

}  // namespace stg::dynamics

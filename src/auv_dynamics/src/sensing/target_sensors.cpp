#include "auv_dynamics/sensing/target_sensor.hpp"

namespace stg::dynamics {

SensorRegistry& TargetSensors() {
  static SensorRegistry registry("target sensor",
                                 {
                                     STG_ENTRY(SensorRegistry, PositionSensorEntry),
                                     STG_ENTRY(SensorRegistry, RangeSensorEntry),
                                     STG_ENTRY(SensorRegistry, BearingSensorEntry),
                                     STG_ENTRY(SensorRegistry, RangeBearingSensorEntry),
                                 });
  return registry;
}

Cue DrawCue(const SensingConfig& config, const EpisodeClock& clock, int k,
            const Vec3<double>& p_WT) {
  Random random = clock.DrawAt(Stream::kCue, 0, static_cast<std::uint32_t>(k));
  const double s = config.cue_std_m;
  Cue cue;
  cue.target = k;
  cue.std_m = s;
  cue.p_WT = p_WT + Vec3<double>{s * random.Normal(), s * random.Normal(), s * random.Normal()};
  return cue;
}

}  // namespace stg::dynamics

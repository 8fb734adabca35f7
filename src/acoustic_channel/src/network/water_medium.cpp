#include "acoustic_channel/network/water_medium.hpp"

#include <algorithm>
#include <utility>

namespace stg::acoustics {

WaterMedium::WaterMedium(const PhysicalConfig& config, int nodes, LineOfSight line_of_sight)
    : surface_z_m_(config.water.surface_z_m),
      shadow_db_(config.propagation.shadow_db),
      propagation_(config.water, config.propagation, std::move(line_of_sight)),
      noise_(config.noise),
      shadowing_(config.propagation, nodes),
      bursts_(config.noise, nodes) {}

void WaterMedium::Reset(std::uint64_t seed, std::uint32_t episode) {
  seed_ = seed;
  episode_ = episode;
  shadowing_.Reset(seed, episode);
  bursts_.Reset(seed, episode);
}

Hearing WaterMedium::Steady(const PathSum& paths, const ModemProfile& sender) const {
  Hearing h;
  h.distance_m = paths.distance_m;
  h.travel_time_s = paths.travel_time_s;
  h.level_db = h.steady_level_db = sender.source_level_db + paths.gain_db;
  h.clear_level_db = h.steady_level_db + (paths.blocked ? shadow_db_ : 0.0);
  return h;
}

Hearing WaterMedium::Hear(const PacketKey& key, const NodeMotion& source,
                          const NodeMotion& receiver, const ModemProfile& sender) {
  const PathSum paths = propagation_.At(source.p_W, receiver.p_W, sender.centre_khz);
  Hearing h = Steady(paths, sender);
  h.level_db += shadowing_.LevelDb(key.source, key.receiver, key.transmit);
  h.level_db += RicianDb(paths.rician_k, seed_, episode_, key.sequence, key.source, key.receiver);
  return h;
}

NoiseSpan WaterMedium::Noise(int node, TimeNs t, double speed_mps, const ModemProfile& receiver) {
  const Bursts::Span span = bursts_.At(node, std::max<TimeNs>(t, 0));
  const double centre = receiver.centre_khz, band = receiver.bandwidth_khz;
  NoiseSpan n;
  n.quiet_level_db = noise_.BandLevelDb(centre, band, speed_mps, false);
  n.level_db = span.loud ? noise_.BandLevelDb(centre, band, speed_mps, true) : n.quiet_level_db;
  n.until = span.end;
  return n;
}

Hearing WaterMedium::Expect(const NodeMotion& source, const NodeMotion& receiver,
                            const ModemProfile& sender) const {
  return Steady(propagation_.At(source.p_W, receiver.p_W, sender.centre_khz), sender);
}

double WaterMedium::SoundSpeed(const Vec3<double>& p_W) const {
  return propagation_.SoundSpeed(std::max(0.0, surface_z_m_ - p_W.z));
}

}  // namespace stg::acoustics

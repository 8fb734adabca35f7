#include "looks.hpp"

#include <cmath>
#include <tuple>

namespace stg::dynamics {

bool LooksNow(const SensingConfig& config, const Look& look) {
  if (config.period_s <= 0.0) return true;
  return look.stamp % static_cast<TimeNs>(std::llround(config.period_s * 1e9)) == 0;
}

bool Blind(const SensingConfig& config, const Look& look) {
  if (config.dropout_rate_hz <= 0.0) return false;
  const auto slot = static_cast<std::uint32_t>(look.time_s / config.dropout_duration_s);
  Random random = look.clock.DrawAt(Stream::kDetection, slot, look.pair | 0x800000U);
  return random.Uniform() < 1.0 - std::exp(-config.dropout_rate_hz * config.dropout_duration_s);
}

void RemoveLabel(Detection* detection) { detection->target = kUnlabelled; }

bool MeasuresLess(const Detection& a, const Detection& b) {
  const auto numbers = [](const Detection& d) {
    return std::make_tuple(d.range_m, d.azimuth_rad, d.elevation_rad, d.p_WT.x, d.p_WT.y, d.p_WT.z);
  };
  return numbers(a) < numbers(b);
}

void SetObserver(const Look& look, Detection* out) {
  out->stamp = look.stamp;
  out->target = look.target;
  out->p_WO = look.observer.p_WO;
  out->p_WO_std_m = look.observer.position_std_m;
  out->heading_std_rad = look.observer.heading_std_rad;
}

}  // namespace stg::dynamics

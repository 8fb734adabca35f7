#include "acoustic_channel/water/noise.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "acoustic_channel/modem/error_rate.hpp"

namespace stg::acoustics {

void Describe(NoiseConfig* c, config::Table* t) {
  t->Section("noise");
  t->Add("shipping", &c->shipping, config::kFraction, "-", "activity of distant ships");
  t->Add("wind_mps", &c->wind_mps, config::NonNegative(60.0), "m/s", "wind over the surface");
  t->Add("site_db", &c->site_db, config::Within(-100.0, 200.0), "dB re 1 uPa^2/Hz",
         "noise of the site with a flat spectrum; its power is added to that of the formulas");
  t->Add("own_db", &c->own_db, config::Within(-100.0, 200.0), "dB re 1 uPa^2/Hz",
         "a vehicle's own noise at its receiver at 1 kHz and 1 m/s; it falls by 6 dB per octave");
  t->Add("own_slope_db", &c->own_slope_db, config::NonNegative(200.0), "dB/decade",
         "growth of a vehicle's own noise with its speed");
  t->Add("burst_db", &c->burst_db, config::NonNegative(100.0), "dB",
         "level by which a burst raises the noise of the sea and of the site");
  t->Add("burst_every_s", &c->burst_every_s, config::NonNegative(1e6), "s",
         "mean time between two bursts at a receiver, from the end of one to the start of the "
         "next; 0: no bursts");
  t->Add("burst_length_s", &c->burst_length_s, config::Within(1e-3, 1e6), "s",
         "mean length of a burst");
  const std::string section = "channel.physical.noise.";
  for (const char* key : {"burst_db", "burst_length_s"}) {
    t->Own(section + key, {"noise bursts", {"on"}, section + "burst_every_s", [c] {
                             return std::vector<std::string>{c->burst_every_s > 0.0 ? "on" : "off"};
                           }});
  }
}

double TurbulenceNoise(double khz) { return 17.0 - 30.0 * std::log10(khz); }

double ShippingNoise(double khz, double shipping) {
  return 40.0 + 20.0 * (shipping - 0.5) + 26.0 * std::log10(khz) - 60.0 * std::log10(khz + 0.03);
}

double WindNoise(double khz, double wind_mps) {
  return 50.0 + 7.5 * std::sqrt(wind_mps) + 20.0 * std::log10(khz) - 40.0 * std::log10(khz + 0.4);
}

double ThermalNoise(double khz) { return -15.0 + 20.0 * std::log10(khz); }

double AmbientNoise(double khz, double shipping, double wind_mps) {
  return RatioToDb(DbToRatio(TurbulenceNoise(khz)) + DbToRatio(ShippingNoise(khz, shipping)) +
                   DbToRatio(WindNoise(khz, wind_mps)) + DbToRatio(ThermalNoise(khz)));
}

double OwnNoise(const NoiseConfig& noise, double khz, double speed_mps) {
  if (speed_mps <= 0.0) return -std::numeric_limits<double>::infinity();
  return noise.own_db + noise.own_slope_db * std::log10(speed_mps) - 20.0 * std::log10(khz);
}

double NoiseModel::BandLevelDb(double centre_khz, double bandwidth_khz, double speed_mps,
                               bool burst) const {
  const double around = DbToRatio(AmbientNoise(centre_khz, noise_.shipping, noise_.wind_mps)) +
                        DbToRatio(noise_.site_db);
  const double raised = burst ? around * DbToRatio(noise_.burst_db) : around;
  const double own = DbToRatio(OwnNoise(noise_, centre_khz, speed_mps));
  return RatioToDb((raised + own) * bandwidth_khz * 1e3);
}

}  // namespace stg::acoustics

#include "acoustic_channel/water/absorption.hpp"

#include <algorithm>
#include <cmath>

namespace stg::acoustics {

double ThorpAbsorption(double khz) {
  const double f2 = khz * khz;
  return 0.11 * f2 / (1.0 + f2) + 44.0 * f2 / (4100.0 + f2) + 2.75e-4 * f2 + 0.003;
}

double FrancoisGarrisonAbsorption(double khz, double temperature_c, double salinity_psu,
                                  double depth_m, double ph) {
  const double f2 = khz * khz, T = temperature_c, S = salinity_psu, D = depth_m;
  const double kelvin = 273.0 + T;
  const double c = 1412.0 + 3.21 * T + 1.19 * S + 0.0167 * D;

  const double A1 = 8.86 / c * std::pow(10.0, 0.78 * ph - 5.0);
  const double f1 = 2.8 * std::sqrt(S / 35.0) * std::pow(10.0, 4.0 - 1245.0 / kelvin);
  const double boric = A1 * f1 * f2 / (f1 * f1 + f2);

  const double A2 = 21.44 * S / c * (1.0 + 0.025 * T);
  const double P2 = 1.0 - 1.37e-4 * D + 6.2e-9 * D * D;
  const double f2r = 8.17 * std::pow(10.0, 8.0 - 1990.0 / kelvin) / (1.0 + 0.0018 * (S - 35.0));
  const double magnesium = A2 * P2 * f2r * f2 / (f2r * f2r + f2);

  const double A3 = T <= 20.0 ? 4.937e-4 - 2.59e-5 * T + 9.11e-7 * T * T - 1.50e-8 * T * T * T
                              : 3.964e-4 - 1.146e-5 * T + 1.45e-7 * T * T - 6.5e-10 * T * T * T;
  const double P3 = 1.0 - 3.83e-5 * D + 4.9e-10 * D * D;
  return boric + magnesium + A3 * P3 * f2;
}

double Absorption(const WaterConfig& water, double khz, double depth_m) {
  if (water.absorption == WaterConfig::Absorption::kThorp) return ThorpAbsorption(khz);
  return FrancoisGarrisonAbsorption(khz, water.temperature_c, water.salinity_psu,
                                    std::max(depth_m, 0.0), water.ph);
}

}  // namespace stg::acoustics

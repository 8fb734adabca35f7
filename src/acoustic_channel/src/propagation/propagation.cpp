#include "acoustic_channel/propagation/propagation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "acoustic_channel/modem/error_rate.hpp"
#include "acoustic_channel/propagation/boundaries.hpp"
#include "acoustic_channel/propagation/image_sources.hpp"
#include "acoustic_channel/water/absorption.hpp"
#include "auv_common/numbers/attitude.hpp"

namespace stg::acoustics {

struct Propagation::Geometry {
  double distance_m, range_m;
  double depth_A_m, depth_B_m;  ///< within the layer
  double slowness;              ///< mean of 1/c between the two [s/m]
};

Propagation::Propagation(const WaterConfig& water, const PropagationConfig& propagation,
                         LineOfSight line_of_sight)
    : water_(water),
      config_(propagation),
      profile_(water),
      line_of_sight_(std::move(line_of_sight)) {}

Propagation::Geometry Propagation::Place(const Vec3<double>& p_A_W,
                                         const Vec3<double>& p_B_W) const {
  const Vec3<double> r_W = p_B_W - p_A_W;
  Geometry g{};
  g.range_m = std::sqrt(r_W.x * r_W.x + r_W.y * r_W.y);
  g.distance_m = Norm(r_W);
  g.depth_A_m = std::clamp(water_.surface_z_m - p_A_W.z, 0.0, water_.depth_m);
  g.depth_B_m = std::clamp(water_.surface_z_m - p_B_W.z, 0.0, water_.depth_m);
  g.slowness = profile_.MeanSlowness(g.depth_A_m, g.depth_B_m);
  return g;
}

PathSum Propagation::At(const Vec3<double>& p_A_W, const Vec3<double>& p_B_W,
                        double centre_khz) const {
  const Geometry g = Place(p_A_W, p_B_W);
  const double middle_m = 0.5 * (g.depth_A_m + g.depth_B_m);
  const double a_db_per_m = Absorption(water_, centre_khz, middle_m) / 1000.0;
  PathSum sum;
  sum.distance_m = g.distance_m;
  sum.travel_time_s = g.distance_m * g.slowness;
  sum.blocked = line_of_sight_ && !line_of_sight_(p_A_W, p_B_W);

  const auto gain_db = [&](double length_m) {
    return -10.0 * config_.spreading * std::log10(std::max(length_m, 1.0)) - a_db_per_m * length_m;
  };
  // The straight path has its true length, even if a node is outside of the layer.
  const double straight_db = gain_db(g.distance_m);
  if (config_.paths == 1) {
    sum.gain_db = straight_db;
    sum.rician_k = std::min(config_.rician_k, kSteadyRicianK);
  } else {
    // Powers are shares of the straight path's power. Delays count from its arrival.
    double others = 0.0, first_moment = 0.0, second_moment = 0.0;
    const double wave_number = 2.0 * kPi * centre_khz * 1e3 * g.slowness;
    ForEachImage(g.range_m, g.depth_A_m, g.depth_B_m, water_.depth_m, config_.paths,
                 [&](const ImagePath& path) {
                   if (path.surface + path.bottom == 0) return;
                   double power = DbToRatio(gain_db(path.length_m) - straight_db);
                   const double surface =
                       SurfaceReflection(path.sin_theta, wave_number, config_.wave_height_rms_m);
                   power *= std::pow(surface * surface, path.surface);
                   if (path.bottom > 0) {
                     const auto bottom =
                         BottomReflection(path.sin_theta, config_.bottom_density_ratio,
                                          config_.bottom_speed_ratio, config_.bottom_loss_db);
                     power *= std::pow(std::norm(bottom), path.bottom);
                   }
                   const double delay_s = (path.length_m - g.distance_m) * g.slowness;
                   others += power;
                   first_moment += power * delay_s;
                   second_moment += power * delay_s * delay_s;
                 });
    const double mean_s = first_moment / (1.0 + others);
    const double variance_s2 = second_moment / (1.0 + others) - mean_s * mean_s;
    sum.gain_db = straight_db + RatioToDb(1.0 + others);
    sum.delay_spread_s = std::sqrt(std::max(variance_s2, 0.0));
    sum.rician_k = others * kSteadyRicianK > 1.0 ? 1.0 / others : kSteadyRicianK;
  }
  if (sum.blocked) {
    sum.gain_db -= config_.shadow_db;
    sum.rician_k = 0.0;
  }
  return sum;
}

std::complex<double> Propagation::Tone(const Vec3<double>& p_A_W, const Vec3<double>& p_B_W,
                                       double khz) const {
  const Geometry g = Place(p_A_W, p_B_W);
  const double a_db_per_m = Absorption(water_, khz, 0.5 * (g.depth_A_m + g.depth_B_m)) / 1000.0;
  const double wave_number = 2.0 * kPi * khz * 1e3 * g.slowness;
  std::complex<double> pressure = 0.0;
  ForEachImage(g.range_m, g.depth_A_m, g.depth_B_m, water_.depth_m, config_.paths,
               [&](const ImagePath& path) {
                 const double length_m = std::max(path.length_m, 1.0);
                 std::complex<double> term =
                     std::polar(std::pow(length_m, -0.5 * config_.spreading) *
                                    std::pow(10.0, -a_db_per_m * path.length_m / 20.0),
                                wave_number * path.length_m);
                 const double surface =
                     SurfaceReflection(path.sin_theta, wave_number, config_.wave_height_rms_m);
                 term *= std::pow(surface, path.surface);
                 if (path.bottom > 0) {
                   term *= std::pow(
                       BottomReflection(path.sin_theta, config_.bottom_density_ratio,
                                        config_.bottom_speed_ratio, config_.bottom_loss_db),
                       path.bottom);
                 }
                 pressure += term;
               });
  return line_of_sight_ && !line_of_sight_(p_A_W, p_B_W)
             ? pressure * std::pow(10.0, -config_.shadow_db / 20.0)
             : pressure;
}

}  // namespace stg::acoustics

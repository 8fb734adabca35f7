#pragma once

#include <optional>

#include "auv_common/config/field.hpp"
#include "auv_common/config/run_config.hpp"

namespace stg::acoustics {

/// The link: all within R_c (Eq. 5), Eq. 6 with loss and delay, or a later physical model.
enum class ChannelModel { kRange, kExtended, kPhysical };

/// The acoustic channel and the link quality of Eqs. 5-6.
struct ChannelConfig {
  ChannelModel model = ChannelModel::kExtended;
  double range_m = 0.45;           ///< R_c of Eq. 5
  double transmit_period_s = 0.5;  ///< every agent sends one packet per period, staggered
  double sound_speed_mps = 1500.0;
  // Eq. 6
  double max_range_m = 3.5;        ///< extended: nothing arrives beyond
  double attenuation_per_m = 0.5;  ///< alpha
  double loss_probability = 0.10;  ///< at zero distance
  double loss_distance_m = 2.0;    ///< p_loss(d) = 1 - (1 - p0) exp(-(d / loss_distance)^2)
  double freshness_s = 2.0;        ///< tau_f
};

/// Keys, units and ranges of the section.
void Describe(ChannelConfig* c, config::Table* t);
/// Contradictions between the section and the clocks of the run.
std::optional<config::Violation> FindConflict(const ChannelConfig& c, const RunConfig& run);

/// What a program needs that runs the network alone.
struct NetworkConfig : RunConfig {
  ChannelConfig channel;
};
void Describe(NetworkConfig* c, config::Table* t);
std::optional<config::Violation> FindConflict(const NetworkConfig& c);

}  // namespace stg::acoustics

#pragma once

#include "acoustic_channel/modem/modem_config.hpp"
#include "acoustic_channel/propagation/propagation_config.hpp"
#include "acoustic_channel/water/noise.hpp"
#include "acoustic_channel/water/water_config.hpp"

namespace stg::acoustics {

/// Sections of `channel.physical`.
struct PhysicalConfig {
  ModemConfig modem;
  WaterConfig water;
  NoiseConfig noise;
  PropagationConfig propagation;
};
void Describe(PhysicalConfig* c, config::Table* t);

}  // namespace stg::acoustics

#pragma once

#include "acoustic_channel/access/contention_config.hpp"
#include "acoustic_channel/access/slots_config.hpp"
#include "acoustic_channel/modem/modem_config.hpp"
#include "acoustic_channel/propagation/propagation_config.hpp"
#include "acoustic_channel/water/noise.hpp"
#include "acoustic_channel/water/water_config.hpp"

namespace stg::acoustics {

/// Sections of `channel` that the model `physical` reads. Files need not state them.
struct PhysicalConfig {
  ModemConfig modem;
  SlotsConfig slots;
  ContentionConfig contention;
  WaterConfig water;
  NoiseConfig noise;
  PropagationConfig propagation;
};
void Describe(PhysicalConfig* c, config::Table* t);

}  // namespace stg::acoustics

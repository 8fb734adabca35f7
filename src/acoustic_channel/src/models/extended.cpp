#include "acoustic_channel/models/extended.hpp"

#include "acoustic_channel/channel_config.hpp"

namespace stg::acoustics {

void Describe(ExtendedConfig* c, config::Table* t) {
  t->Add("sound_speed_mps", &c->sound_speed_mps, config::Within(1.0, 1e5), "m/s",
         "propagation speed of packets");
  t->Add("max_range_m", &c->max_range_m, config::Positive(1e6), "m",
         "nothing arrives beyond this distance");
  t->Add("attenuation_per_m", &c->attenuation_per_m, config::NonNegative(1e4), "1/m",
         "alpha of Eq. 6");
  t->Add("loss_probability", &c->loss_probability, config::kFraction, "-",
         "probability p0 that a packet is lost at zero distance");
  t->Add("loss_distance_m", &c->loss_distance_m, config::Positive(1e6), "m",
         "scale D of p_loss(d) = 1 - (1 - p0) exp(-(d/D)^2)");
  t->Add("freshness_s", &c->freshness_s, config::Positive(1e5), "s",
         "decay time tau_f of Eq. 6 with the age of the information");
}

ExtendedModel::ExtendedModel(const ChannelConfig& config) : config_(config.extended) {}

}  // namespace stg::acoustics

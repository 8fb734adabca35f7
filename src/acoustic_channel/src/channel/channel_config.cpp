#include "acoustic_channel/channel/channel_config.hpp"

namespace stg::acoustics {

using config::Enum;
using config::kFraction;
using config::kNone;
using config::NonNegative;
using config::Positive;
using config::Within;

void Describe(ChannelConfig* c, config::Table* t) {
  t->Section("channel");
  t->Add("model", config::Enum(&c->model, {"range", "extended", "physical"}), config::kNone, "-",
         "link model: Eq. 5, Eq. 6, or the acoustic modem");
  t->Add("range_m", &c->range_m, config::Positive(1e6), "m", "range: R_c of Eq. 5");
  t->Add("transmit_period_s", &c->transmit_period_s, config::Positive(1e4), "s",
         "every AUV sends one packet per period, staggered; at least one decision");
  t->Add("sound_speed_mps", &c->sound_speed_mps, config::Within(1.0, 1e5), "m/s",
         "propagation speed of packets");
  t->Add("max_range_m", &c->max_range_m, config::Positive(1e6), "m",
         "extended: nothing arrives beyond this distance");
  t->Add("attenuation_per_m", &c->attenuation_per_m, config::NonNegative(1e4), "1/m",
         "extended: alpha of Eq. 6");
  t->Add("loss_probability", &c->loss_probability, config::kFraction, "-",
         "extended: probability p0 that a packet is lost at zero distance");
  t->Add("loss_distance_m", &c->loss_distance_m, config::Positive(1e6), "m",
         "extended: scale D of p_loss(d) = 1 - (1 - p0) exp(-(d/D)^2)");
  t->Add("freshness_s", &c->freshness_s, config::Positive(1e5), "s",
         "extended: decay time tau_f of Eq. 6 with the age of the information");
}

std::optional<config::Violation> FindConflict(const ChannelConfig& c, const RunConfig& run) {
  if (c.transmit_period_s < run.decision_dt_s() * (1.0 - 1e-9)) {
    return config::Violation{{"channel.transmit_period_s", "time.dt_s", "time.decision_steps"},
                             "an AUV sends at most one packet per decision"};
  }
  return {};
}

void Describe(NetworkConfig* c, config::Table* t) {
  Describe(static_cast<RunConfig*>(c), t);
  Describe(&c->channel, t);
}

std::optional<config::Violation> FindConflict(const NetworkConfig& c) {
  if (auto violation = FindConflict(static_cast<const RunConfig&>(c))) return violation;
  return FindConflict(c.channel, c);
}

}  // namespace stg::acoustics

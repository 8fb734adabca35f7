#include "acoustic_channel/models/range.hpp"

#include "acoustic_channel/channel_config.hpp"

namespace stg::acoustics {

void Describe(RangeConfig* c, config::Table* t) {
  t->Add("freshness_s", &c->freshness_s, config::Positive(1e5), "s",
         "decay time of shared estimates with their age");
}

RangeModel::RangeModel(const ChannelConfig& config)
    : range_m_(config.range_m), freshness_s_(config.range.freshness_s) {}

}  // namespace stg::acoustics

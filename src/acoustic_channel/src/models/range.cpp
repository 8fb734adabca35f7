#include "acoustic_channel/models/range.hpp"

#include "acoustic_channel/channel_config.hpp"

namespace stg::acoustics {

void Describe(RangeConfig* c, config::Table* t) {
  t->Add("range_m", &c->range_m, config::Positive(1e6), "m", "range: R_c of Eq. 5");
}

RangeModel::RangeModel(const ChannelConfig& config)
    : range_m_(config.range_m), freshness_s_(config.freshness_s) {}

}  // namespace stg::acoustics

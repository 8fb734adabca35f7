#include "acoustic_channel/models/propagation_model.hpp"

#include "acoustic_channel/models/extended.hpp"
#include "acoustic_channel/models/independent_model.hpp"
#include "acoustic_channel/models/range.hpp"

namespace stg::acoustics {

PropagationModelRegistry& PropagationModels() {
  // clang-format off
  static PropagationModelRegistry registry("propagation model", {
      {"range", MakeIndependentModel<RangeModel>},
      {"extended", MakeIndependentModel<ExtendedModel>},
  });
  // clang-format on
  return registry;
}

std::unique_ptr<Channel> MakeChannel(const ChannelConfig& config, const RunConfig& run) {
  return PropagationModels().Make(config.model, config)->MakeChannel(config, run);
}

std::unique_ptr<LinkEstimator> MakeLinkEstimator(const ChannelConfig& config) {
  return PropagationModels().Make(config.model, config)->MakeLinkEstimator();
}

}  // namespace stg::acoustics

#include "acoustic_channel/models/propagation_model.hpp"

#include <utility>

#include "acoustic_channel/models/extended.hpp"
#include "acoustic_channel/models/independent_model.hpp"
#include "acoustic_channel/models/physical.hpp"
#include "acoustic_channel/models/range.hpp"

namespace stg::acoustics {

PropagationModelRegistry& PropagationModels() {
  // clang-format off
  static PropagationModelRegistry registry("propagation model", {
      {"range", MakeIndependentModel<RangeModel>},
      {"extended", MakeIndependentModel<ExtendedModel>},
      {"physical", MakePhysicalModel},
  });
  // clang-format on
  return registry;
}

std::unique_ptr<Channel> MakeChannel(const ChannelConfig& config, const RunConfig& run,
                                     LineOfSight line_of_sight) {
  const auto model = PropagationModels().Make(config.model, config.models, config);
  return model->MakeChannel(config, run, std::move(line_of_sight));
}

std::unique_ptr<LinkEstimator> MakeLinkEstimator(const ChannelConfig& config, int nodes) {
  return PropagationModels()
      .Make(config.model, config.models, config)
      ->MakeLinkEstimator(config, nodes);
}

std::size_t MaxPayload(const ChannelConfig& config, int nodes) {
  return PropagationModels().Make(config.model, config.models, config)->max_payload(config, nodes);
}

}  // namespace stg::acoustics

#include "acoustic_channel/models/propagation_model.hpp"

#include "acoustic_channel/models/independent_model.hpp"

namespace stg::acoustics {

PropagationModelRegistry& PropagationModels() {
  static PropagationModelRegistry registry("propagation model",
                                           {
                                               {"range", MakeIndependentModel<RangeModel>},
                                               {"extended", MakeIndependentModel<ExtendedModel>},
                                           });
  return registry;
}

std::unique_ptr<LinkEstimator> MakeLinkEstimator(const ChannelConfig& config) {
  return PropagationModels().Make(config.model, config)->MakeLinkEstimator();
}

}  // namespace stg::acoustics

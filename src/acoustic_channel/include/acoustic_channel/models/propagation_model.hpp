#pragma once

#include <memory>

#include "acoustic_channel/channel/channel.hpp"
#include "acoustic_channel/channel_config.hpp"
#include "acoustic_channel/link/link_estimator.hpp"
#include "auv_common/registry.hpp"

/// Propagation models: how packets travel, and what a link is worth.
namespace stg::acoustics {

/// A model as the section `channel` describes it. Makes the two things that must agree: the
/// channel, which knows the truth, and the estimate that a node makes of a link from what it knows.
class PropagationModel {
 public:
  virtual ~PropagationModel() = default;
  virtual std::unique_ptr<Channel> MakeChannel(const ChannelConfig& config,
                                               const RunConfig& run) const = 0;
  virtual std::unique_ptr<LinkEstimator> MakeLinkEstimator() const = 0;
};

/// All models, by the name that `channel.model` takes.
using PropagationModelRegistry = Registry<PropagationModel, const ChannelConfig&>;
PropagationModelRegistry& PropagationModels();

}  // namespace stg::acoustics

#pragma once

#include <memory>

#include "acoustic_channel/access/medium_access.hpp"
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
  virtual std::unique_ptr<Channel> MakeChannel(const ChannelConfig& config, const RunConfig& run,
                                               LineOfSight line_of_sight) const = 0;
  virtual std::unique_ptr<LinkEstimator> MakeLinkEstimator(const ChannelConfig& config,
                                                           int nodes) const = 0;

  /// True: nodes have modems, which know when they are busy, hear carriers and take frames of a
  /// certain length. False: packets leave at decisions and take no time.
  virtual bool has_modems() const { return false; }
  /// What the longest packet takes; see MediumAccess::FindConflict.
  virtual PacketTime packet_time(const ChannelConfig&, int /*nodes*/) const { return {}; }
  /// Longest payload of a packet [bytes].
  virtual std::size_t max_payload(const ChannelConfig&, int /*nodes*/) const {
    return kLargestFrame;
  }
  /// Why the model cannot work with the section; nothing: it can.
  virtual std::optional<config::Violation> FindConflict(const ChannelConfig&, int /*nodes*/) const {
    return {};
  }
};

/// All models, by the name that `channel.model` takes.
using PropagationModelRegistry = Registry<PropagationModel, const ChannelConfig&>;
PropagationModelRegistry& PropagationModels();

/// Longest payload that the section's channel carries between so many nodes [bytes]. Throws
/// UserError for a model or a modem that does not exist.
std::size_t MaxPayload(const ChannelConfig& config, int nodes);

}  // namespace stg::acoustics

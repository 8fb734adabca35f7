#pragma once

#include <memory>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/channel/channel.hpp"
#include "acoustic_channel/channel_config.hpp"
#include "acoustic_channel/link/link_estimator.hpp"
#include "auv_common/registry.hpp"

/// Propagation models: how packets travel, and the quality of links.
namespace stg::acoustics {

/// A model that the section `channel` describes. It makes two objects that must agree: the channel,
/// which knows the true states, and the estimator with which a node rates its links.
class PropagationModel {
 public:
  virtual ~PropagationModel() = default;
  virtual std::unique_ptr<Channel> MakeChannel(const ChannelConfig& config, const RunConfig& run,
                                               LineOfSight line_of_sight) const = 0;
  virtual std::unique_ptr<LinkEstimator> MakeLinkEstimator(const ChannelConfig& config,
                                                           int nodes) const = 0;

  /// True: nodes have modems, which can be busy, detect carriers and have frames of a limited
  /// length. False: packets leave at decisions and have no airtime.
  virtual bool has_modems() const { return false; }
  /// Airtime and turnaround of the longest packet; see MediumAccess::FindConflict.
  virtual PacketTime packet_time(const ChannelConfig&, int /*nodes*/) const { return {}; }
  /// Longest payload of a packet [bytes].
  virtual std::size_t max_payload(const ChannelConfig&, int /*nodes*/) const {
    return kLargestFrame;
  }
  /// The reason why the model cannot work with the section; nothing: it can.
  virtual std::optional<config::Violation> FindConflict(const ChannelConfig&, int /*nodes*/) const {
    return {};
  }
};

/// All models, by their names for `channel.model`.
using PropagationModelRegistry = Registry<PropagationModel, const ChannelConfig&>;
PropagationModelRegistry& PropagationModels();

/// Longest payload that the section's channel carries between so many nodes [bytes]. Throws
/// UserError for a model or a modem that does not exist.
std::size_t MaxPayload(const ChannelConfig& config, int nodes);

}  // namespace stg::acoustics

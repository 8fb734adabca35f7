#pragma once

#include <memory>

#include "acoustic_channel/modem/packet.hpp"
#include "auv_common/numbers/lanes.hpp"

namespace stg::acoustics {

struct ChannelConfig;

/// What a node thinks of its links, from what it knows: how far away the other one is, how old the
/// news of it is, and what it received so far. Comes with the propagation model, so that a channel
/// and those who use it mean the same by the quality of a link.
///
/// One object serves one node, or the same node in kLanes environments, of which `lane` names one;
/// a single node is lane 0.
class LinkEstimator {
 public:
  virtual ~LinkEstimator() = default;

  /// Quality in [0, 1] of a link to a node at distance d [m] of which the newest information has
  /// this age [s]; 1 is best. Both versions agree bit for bit.
  virtual double Quality(double d, double age_s) const = 0;
  virtual Pack Quality(const Pack& d, const Pack& age_s) const = 0;

  /// Information older than this is not current [s].
  virtual double freshness_s() const = 0;

  /// Starts an episode in one lane: what was learnt there is forgotten.
  virtual void Reset(int /*lane*/) {}
  /// A packet came in: a model whose constants are not known beforehand may learn from it.
  virtual void Learn(int /*lane*/, const Reception& /*reception*/) {}
};

/// The estimator of the section's propagation model. Throws UserError for one that does not exist.
std::unique_ptr<LinkEstimator> MakeLinkEstimator(const ChannelConfig& config);

}  // namespace stg::acoustics

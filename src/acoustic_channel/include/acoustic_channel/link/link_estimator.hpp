#pragma once

#include <memory>

#include "acoustic_channel/modem/packet.hpp"
#include "auv_common/numbers/lanes.hpp"

namespace stg::acoustics {

struct ChannelConfig;

/// A node's estimate of its links, from its own knowledge: the distance to the other node, the age
/// of the newest information, and the receptions so far. The propagation model makes it, so that
/// the channel and its users compute the same quality of a link.
///
/// One object serves one node, or the same node in kLanes environments; then `lane` selects the
/// environment. A single node is lane 0.
class LinkEstimator {
 public:
  virtual ~LinkEstimator() = default;

  /// Quality in [0, 1] of a link to a node at distance d [m] of which the newest information has
  /// this age [s]; 1 is best. Both versions agree bit for bit.
  /// @param learnt of that link, see Learnt
  virtual double Quality(double d, double age_s, double learnt) const = 0;
  virtual Pack Quality(const Pack& d, const Pack& age_s, const Pack& learnt) const = 0;
  double Quality(double d, double age_s) const { return Quality(d, age_s, 1.0); }
  Pack Quality(const Pack& d, const Pack& age_s) const { return Quality(d, age_s, Pack(1.0)); }

  /// Value learnt from receptions of the link from node `source`: one number for each lane,
  /// [kLanes]. All are 1 for a model with known constants.
  virtual const double* Learnt(int source) const;

  /// Information older than this is not current [s].
  virtual double freshness_s() const = 0;

  /// Starts an episode in one lane: resets the learnt values of this lane.
  virtual void Reset(int /*lane*/) {}
  /// Called for each received packet: a model with unknown constants may learn from it. The packets
  /// of one source come in order of arrival.
  virtual void Learn(int /*lane*/, const Reception& /*reception*/) {}
};

/// The estimator of the section's propagation model, for a network of so many nodes. Throws
/// UserError for a model that does not exist.
std::unique_ptr<LinkEstimator> MakeLinkEstimator(const ChannelConfig& config, int nodes);

}  // namespace stg::acoustics

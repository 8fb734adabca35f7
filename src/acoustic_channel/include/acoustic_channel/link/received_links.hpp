#pragma once

#include <array>
#include <vector>

#include "acoustic_channel/link/link_estimator.hpp"
#include "acoustic_channel/modem/modem_profile.hpp"

namespace stg::acoustics {

/// Link quality from received packets, independent of the distance.
///
/// Every packet of a source is a sample: a packet that is missing in the sequence numbers counts 0,
/// and a received one counts the probability that a packet survives at its SINR minus a margin of
/// kMarginDb. `learnt` is their running mean with weight kGain; quality is that times exp(-age /
/// freshness). The quality is too low for a source that sends to others, because its numbers then
/// have gaps.
class ReceivedLinks : public LinkEstimator {
 public:
  static constexpr double kGain = 0.2, kMarginDb = 3.0;

  /// Throws UserError for a modem that does not exist.
  ReceivedLinks(const ModemConfig& config, int nodes);

  using LinkEstimator::Quality;
  double Quality(double d, double age_s, double learnt) const override;
  Pack Quality(const Pack& d, const Pack& age_s, const Pack& learnt) const override;
  const double* Learnt(int source) const override;
  double freshness_s() const override { return freshness_s_; }
  void Reset(int lane) override;
  void Learn(int lane, const Reception& reception) override;

 private:
  struct Link {
    std::array<double, kLanes> learnt;
    std::array<std::int64_t, kLanes> next;  ///< sequence after the last received one; 0: none
  };

  double freshness_s_;
  std::vector<ModemProfile> fleet_;  ///< [nodes]
  std::vector<Link> links_;          ///< [nodes], from this source
};

}  // namespace stg::acoustics

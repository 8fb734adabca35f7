#pragma once

#include <cstdint>
#include <vector>

#include "acoustic_channel/propagation/propagation_config.hpp"
#include "auv_common/time.hpp"

namespace stg::acoustics {

/// Slow fading: for every pair of nodes a level [dB], normal around 0 with standard deviation
/// `shadowing_db`, of autocorrelation exp(-|dt| / shadowing_time_s) (first-order autoregression; M.
/// Gudmundson, Electronics Letters 27 (1991) 2145, over time instead of way). Both directions of a
/// link have the same level. A draw depends on seed, episode, link and the number of earlier times
/// for this link, not on calls for other links.
class Shadowing {
 public:
  Shadowing(const PropagationConfig& config, int nodes);

  void Reset(std::uint64_t seed, std::uint32_t episode);

  /// Level at time t, which must not be before the last t of this link. The same t gives the same
  /// level.
  double LevelDb(int a, int b, TimeNs t);

 private:
  struct Link {
    TimeNs t = 0;
    std::uint32_t draws = 0;  ///< 0: never asked
    double normal = 0.0;      ///< of unit variance
  };

  double sigma_db_, rate_per_s_;
  int nodes_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
  std::vector<Link> links_;  ///< of a < b, by rows
};

/// Fast fading of one packet on its way to one receiver [dB]: the power |h|^2 of a constant and a
/// complex normal part whose powers are as K to 1, of mean 1 (Rice; K = 0: Rayleigh). 0 dB for K >=
/// kSteadyRicianK. A pure function of its arguments.
/// @param sequence of the packet at its source
double RicianDb(double rician_k, std::uint64_t seed, std::uint32_t episode, std::uint32_t sequence,
                int source, int receiver);

}  // namespace stg::acoustics

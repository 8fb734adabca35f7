#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "acoustic_channel/modem/packet.hpp"
#include "auv_common/numbers/vector.hpp"
#include "stg_agent/agent_config.hpp"

namespace stg::agent {

/// The ultra-short baselines of the AUVs' modems (localization.ranges.usbl_std_deg): the direction
/// of the sender of each received packet, and of the members that answer pings, in body axes. As in
/// the channel's ranges, both positions are those at transmission, of an answer those in the middle
/// of its round trip. The attitude is that at the last decision before the arrival. The
/// error has the same standard deviation in each direction across the line of sight. So it does not
/// depend on the axes, and the azimuth of a sender far above or below has a larger error.
///
/// Use in each episode: Reset; then, for each decision, Turn, and Measure after each Deliver.
class AuvUsbl {
 public:
  explicit AuvUsbl(const AgentModel& model);

  void Reset(std::uint64_t seed, std::uint32_t episode);
  /// @param R_WB true attitudes of the AUVs
  void Turn(const std::vector<Mat3<double>>& R_WB) { R_WB_ = R_WB; }
  /// Adds the directions to AUV `receiver`'s receptions from `first` on.
  /// @param t time of the positions and velocities of all members
  void Measure(int receiver, TimeNs t, const std::vector<Vec3<double>>& p_W,
               const std::vector<Vec3<double>>& v_W, std::size_t first,
               std::vector<acoustics::Reception>* out) const;

 private:
  int members_;
  double std_rad_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
  std::vector<Mat3<double>> R_WB_;  // [AUVs]
};

}  // namespace stg::agent

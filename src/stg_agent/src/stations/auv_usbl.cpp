#include "auv_usbl.hpp"

#include <cmath>

#include "auv_common/numbers/attitude.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::agent {

AuvUsbl::AuvUsbl(const AgentModel& model)
    : members_(model.members()),
      std_rad_(model.localization.usbl_std_deg * kPi / 180.0),
      R_WB_(static_cast<std::size_t>(model.run.agents), RotationOf(TrigOf(Vec3<double>()))) {}

void AuvUsbl::Reset(std::uint64_t seed, std::uint32_t episode) {
  seed_ = seed;
  episode_ = episode;
}

void AuvUsbl::Measure(int receiver, TimeNs t, const std::vector<Vec3<double>>& p_W,
                      const std::vector<Vec3<double>>& v_W, std::size_t first,
                      std::vector<acoustics::Reception>* out) const {
  const auto i = static_cast<std::size_t>(receiver);
  for (std::size_t k = first; k < out->size(); ++k) {
    acoustics::Reception& r = (*out)[k];
    if (r.source >= members_) continue;  // a target
    const bool answer = r.payload.size == 0;
    const TimeNs at = answer ? r.generation : r.transmit;
    const auto j = static_cast<std::size_t>(r.source);
    const Vec3<double> way = p_W[j] - p_W[i] - (v_W[j] - v_W[i]) * Seconds(t - at);
    const Vec3<double> r_B = R_WB_[i].TransposeTimes(way);
    const double level = std::hypot(r_B.x, r_B.y), range = std::hypot(level, r_B.z);
    if (level < 1e-6) continue;  // straight above or below there is no azimuth
    // A ping may have the number of a packet, so that answers have links of their own.
    const int link = r.source * members_ + receiver + (answer ? members_ * members_ : 0);
    Random random(seed_, Stream::kBearing, episode_, r.sequence, static_cast<std::uint32_t>(link));
    const double port = std_rad_ * random.Normal(), up = std_rad_ * random.Normal();
    const double c = level / range, s = r_B.z / range;
    // In axes along, to port of, and above the line of sight, the measured one is (1, port, up).
    r.has_direction = true;
    r.azimuth_rad = WrapAngle(std::atan2(r_B.y, r_B.x) + std::atan2(port, c - up * s));
    r.elevation_rad = std::atan2(s + up * c, std::hypot(c - up * s, port));
  }
}

}  // namespace stg::agent

#include "acoustic_channel/link/received_links.hpp"

#include <algorithm>
#include <cmath>

namespace stg::acoustics {
namespace {

constexpr std::int64_t kLongestGap = 20;  ///< more losses in a row change nothing

template <class T>
T Fresh(const T& age_s, const T& learnt, double freshness_s) {
  return learnt * Exp(age_s * T(-1.0 / freshness_s));
}

/// A pack with the value 1 in all lanes.
const std::array<double, kLanes>& Ones() {
  static const std::array<double, kLanes> ones = [] {
    std::array<double, kLanes> a{};
    a.fill(1.0);
    return a;
  }();
  return ones;
}

}  // namespace

const double* LinkEstimator::Learnt(int /*source*/) const { return Ones().data(); }

ReceivedLinks::ReceivedLinks(const ModemConfig& config, int nodes)
    : freshness_s_(config.freshness_s),
      fleet_(MakeProfiles(config, nodes)),
      links_(static_cast<std::size_t>(nodes)) {
  for (int lane = 0; lane < kLanes; ++lane) ReceivedLinks::Reset(lane);
}

double ReceivedLinks::Quality(double /*d*/, double age_s, double learnt) const {
  return Fresh(age_s, learnt, freshness_s_);
}
Pack ReceivedLinks::Quality(const Pack& /*d*/, const Pack& age_s, const Pack& learnt) const {
  return Fresh(age_s, learnt, freshness_s_);
}

const double* ReceivedLinks::Learnt(int source) const {
  return links_[static_cast<std::size_t>(source)].learnt.data();
}

void ReceivedLinks::Reset(int lane) {
  for (Link& link : links_) {
    link.learnt[static_cast<std::size_t>(lane)] = 1.0;
    link.next[static_cast<std::size_t>(lane)] = 0;
  }
}

void ReceivedLinks::Learn(int lane, const Reception& reception) {
  if (reception.source < 0 || reception.source >= static_cast<int>(links_.size())) return;
  const auto source = static_cast<std::size_t>(reception.source);
  const ModemProfile& p = fleet_[source];
  double sample = 1.0;
  // A real modem may report neither noise nor ratio. Then only losses count.
  const bool measured = reception.sinr_db != 0.0 || reception.noise_level_db != 0.0;
  if (!p.ideal && measured) {
    const double bits = 8.0 * static_cast<double>(p.frames(reception.payload.size) * p.frame_bytes);
    sample =
        std::exp(p.errors.LogSuccess(reception.sinr_db - p.implementation_db - kMarginDb, bits));
  }
  double& learnt = links_[source].learnt[static_cast<std::size_t>(lane)];
  std::int64_t& next = links_[source].next[static_cast<std::size_t>(lane)];
  const auto sequence = static_cast<std::int64_t>(reception.sequence);
  if (next == 0) {
    learnt = sample;
  } else {
    const std::int64_t lost = std::clamp<std::int64_t>(sequence - next, 0, kLongestGap);
    for (std::int64_t k = 0; k < lost; ++k) learnt *= 1.0 - kGain;
    learnt += kGain * (sample - learnt);
  }
  next = sequence + 1;
}

}  // namespace stg::acoustics

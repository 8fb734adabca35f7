#include "acoustic_channel/propagation/bursts.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "auv_common/numbers/random.hpp"

namespace stg::acoustics {

Bursts::Bursts(const NoiseConfig& config, int nodes)
    : every_s_(config.burst_every_s),
      length_s_(config.burst_length_s),
      cursors_(static_cast<std::size_t>(nodes)) {
  Reset(0, 0);
}

void Bursts::Reset(std::uint64_t seed, std::uint32_t episode) {
  seed_ = seed;
  episode_ = episode;
  for (std::size_t i = 0; i < cursors_.size(); ++i) {
    cursors_[i] = {0, 0, Duration(static_cast<int>(i), 0)};
  }
}

TimeNs Bursts::Duration(int node, std::uint32_t index) const {
  if (every_s_ == 0.0) return std::numeric_limits<TimeNs>::max();
  Random random(seed_, Stream::kBurst, episode_, index, static_cast<std::uint32_t>(node));
  const double mean_s = index % 2 == 0 ? every_s_ : length_s_;
  const double seconds = -mean_s * std::log(1.0 - random.Uniform());
  return std::max<TimeNs>(1, std::llround(seconds * 1e9));
}

Bursts::Span Bursts::At(int node, TimeNs t) {
  assert(t >= 0);
  Cursor& at = cursors_[static_cast<std::size_t>(node)];
  while (t >= at.end) {
    at.begin = at.end;
    at.end += Duration(node, ++at.index);
  }
  while (t < at.begin) {
    at.end = at.begin;
    at.begin -= Duration(node, --at.index);
  }
  return {at.index % 2 == 1, at.begin, at.end};
}

}  // namespace stg::acoustics

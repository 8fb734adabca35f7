#include "acoustic_channel/propagation/fading.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "acoustic_channel/modem/error_rate.hpp"
#include "acoustic_channel/propagation/propagation.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::acoustics {

Shadowing::Shadowing(const PropagationConfig& config, int nodes)
    : sigma_db_(config.shadowing_db),
      rate_per_s_(1.0 / config.shadowing_time_s),
      nodes_(nodes),
      links_(static_cast<std::size_t>(nodes * (nodes - 1) / 2)) {}

void Shadowing::Reset(std::uint64_t seed, std::uint32_t episode) {
  seed_ = seed;
  episode_ = episode;
  std::fill(links_.begin(), links_.end(), Link{});
}

double Shadowing::LevelDb(int a, int b, TimeNs t) {
  assert(a != b && a >= 0 && b >= 0 && a < nodes_ && b < nodes_);
  if (sigma_db_ == 0.0) return 0.0;
  const int lo = std::min(a, b), hi = std::max(a, b);
  const int index = lo * nodes_ - lo * (lo + 1) / 2 + hi - lo - 1;
  Link& link = links_[static_cast<std::size_t>(index)];
  if (link.draws == 0 || t != link.t) {
    assert(link.draws == 0 || t > link.t);
    Random random(seed_, Stream::kShadowing, episode_, link.draws,
                  static_cast<std::uint32_t>(index));
    const double keep = link.draws == 0 ? 0.0 : std::exp(-Seconds(t - link.t) * rate_per_s_);
    link.normal = keep * link.normal + std::sqrt(1.0 - keep * keep) * random.Normal();
    link.t = t;
    ++link.draws;
  }
  return sigma_db_ * link.normal;
}

double RicianDb(double rician_k, std::uint64_t seed, std::uint32_t episode, std::uint32_t sequence,
                int source, int receiver) {
  if (rician_k >= kSteadyRicianK) return 0.0;
  // 12 bits each, because a channel with more nodes would not fit into memory.
  assert(source >= 0 && source < 4096 && receiver >= 0 && receiver < 4096);
  Random random(seed, Stream::kFading, episode, sequence,
                static_cast<std::uint32_t>(source) << 12 | static_cast<std::uint32_t>(receiver));
  const double scale = std::sqrt(0.5 / (1.0 + rician_k));
  const double re = std::sqrt(rician_k / (1.0 + rician_k)) + scale * random.Normal();
  const double im = scale * random.Normal();
  return RatioToDb(re * re + im * im);
}

}  // namespace stg::acoustics

#include "acoustic_channel/access/csma.hpp"

#include <algorithm>
#include <cmath>

#include "acoustic_channel/channel_config.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::acoustics {
namespace {

constexpr std::uint32_t kDoublings = 5;

}  // namespace

TimeNs Csma::Next(int node, TimeNs from, const Attempt& attempt) const {
  if (attempt.tries == 0) return Rested(node, from, attempt);
  // The low bits of the index are the node, so that no two tries share a draw.
  const std::uint32_t index = static_cast<std::uint32_t>(node) | (attempt.tries % 4096) << 12;
  Random random(seed_, Stream::kMediumAccess, episode_, attempt.sequence, index);
  const double longest_s = config_.backoff_s * std::exp2(std::min(attempt.tries - 1, kDoublings));
  return from + std::llround(std::max(1.0, longest_s * (1.0 - random.Uniform()) * 1e9));
}

std::unique_ptr<MediumAccess> MakeCsma(const ChannelConfig& config, const RunConfig&) {
  return std::make_unique<Csma>(config.contention);
}

}  // namespace stg::acoustics

#include "acoustic_channel/access/aloha.hpp"

#include <algorithm>
#include <cmath>

#include "acoustic_channel/channel_config.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::acoustics {

void Describe(ContentionConfig* c, config::Table* t) {
  t->Add("rest_s", &c->rest_s, config::NonNegative(1e4), "s",
         "mean of the random pause after a transmission; 0: no pause");
}

void DescribeBackoff(ContentionConfig* c, config::Table* t) {
  t->Add("backoff_s", &c->backoff_s, config::Within(1e-3, 1e4), "s",
         "largest first random wait of a modem that hears a transmission; the limit doubles with "
         "each further wait, up to 32 times this value");
}

void Aloha::Reset(std::uint64_t seed, std::uint32_t episode) {
  seed_ = seed;
  episode_ = episode;
}

TimeNs Aloha::Rested(int node, TimeNs from, const Attempt& attempt) const {
  if (config_.rest_s <= 0.0 || attempt.last_end == kNever) return from;
  Random random(seed_, Stream::kMediumAccess, episode_, attempt.sequence,
                static_cast<std::uint32_t>(node));
  const double rest_s = -config_.rest_s * std::log(1.0 - random.Uniform());
  return std::max(from, attempt.last_end + static_cast<TimeNs>(std::llround(rest_s * 1e9)));
}

TimeNs Aloha::Next(int node, TimeNs from, const Attempt& attempt) const {
  return Rested(node, from, attempt);
}

std::unique_ptr<MediumAccess> MakeAloha(const ChannelConfig& config, const RunConfig&) {
  return std::make_unique<Aloha>(config.contention);
}

}  // namespace stg::acoustics

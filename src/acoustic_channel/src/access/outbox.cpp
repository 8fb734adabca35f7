#include "acoustic_channel/access/outbox.hpp"

#include <algorithm>

namespace stg::acoustics {

Outbox::Outbox(const ChannelConfig& config, const RunConfig& run)
    : turns_(config, run),
      sequence_(static_cast<std::size_t>(run.agents), 0),
      waiting_(sequence_.size()) {}

void Outbox::Reset(std::uint64_t seed, std::uint32_t episode) {
  turns_.Reset(seed, episode);
  std::fill(sequence_.begin(), sequence_.end(), 0);
  for (Waiting& w : waiting_) w.full = false;
  full_ = 0;
}

void Outbox::Keep(const Transmission& packet, Waiting* w) {
  w->bytes.assign(packet.payload.data, packet.payload.data + packet.payload.size);
  w->packet = packet;
  w->packet.payload = ViewOf(w->bytes);
  w->full = true;
}

}  // namespace stg::acoustics

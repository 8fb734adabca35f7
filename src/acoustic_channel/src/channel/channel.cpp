#include "acoustic_channel/channel/channel.hpp"

#include <string>

#include "auv_common/error.hpp"

namespace stg::acoustics {

void Channel::CheckOrThrow(const Transmission& packet) const {
  const auto refuse = [](const std::string& why) { throw UserError("packet: " + why); };
  if (packet.source < 0 || packet.source >= nodes()) {
    refuse("source " + std::to_string(packet.source) + " does not exist");
  }
  if (packet.destination != kToAll && (packet.destination < 0 || packet.destination >= nodes() ||
                                       packet.destination == packet.source)) {
    refuse("destination " + std::to_string(packet.destination) +
           " is neither another node nor all nodes, for source " + std::to_string(packet.source));
  }
  if (packet.payload.size == 0 || packet.payload.size > max_payload()) {
    refuse(std::to_string(packet.payload.size) + " bytes of payload, a frame takes 1 to " +
           std::to_string(max_payload()));
  }
  if (packet.generation > packet.stamp)
    refuse("its generation time is later than the time at which it is offered");
}

void Channel::Ping(int, int, TimeNs, TimeNs, std::uint32_t) {
  throw UserError("ping: this channel model cannot measure ranges; set channel.model to physical");
}

}  // namespace stg::acoustics

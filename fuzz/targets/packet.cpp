#include "stg_agent/packet/packet.hpp"

#include "auv_common/error.hpp"
#include "target.hpp"

/// Eight bytes of the receiver's clock, then a packet of any size. An accepted one can be encoded
/// again with the same result, unless it is marked as clipped.
bool stg::fuzz::RunPacket(const std::string& bytes) {
  static const agent::PacketCodec codec{agent::AgentModel()};
  Bytes in(bytes);
  const TimeNs now = in.Take<TimeNs>();
  const std::string packet = bytes.size() > sizeof now ? in.Rest() : "";
  try {
    const agent::NeighbourState state =
        codec.Decode(reinterpret_cast<const std::uint8_t*>(packet.data()), packet.size(), now);
    Require(state.generation <= now && state.generation >= 0, "a packet of the future");
    const agent::Packet sent = codec.Encode(state);
    const agent::NeighbourState again = codec.Decode(sent.data(), sent.size(), now);
    Require(again.source == state.source && again.generation == state.generation &&
                again.p_W.x == state.p_W.x && again.v_W.y == state.v_W.y &&
                again.p_WT.z == state.p_WT.z && again.target == state.target,
            "a packet is another one when it is sent on");
    return true;
  } catch (const UserError&) {
    return false;
  }
}

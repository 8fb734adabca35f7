#pragma once

#include <auv_msgs/ReceivedPacket.h>

#include <algorithm>

#include "acoustic_channel/channel/channel.hpp"
#include "auv_common/nodes/conversions.hpp"

namespace stg::nodes {

/// `start` is the clock time of the episode's step 0 [ns]: the core counts from there.
inline void SetReceivedPacket(const acoustics::Reception& r, TimeNs start,
                              auv_msgs::ReceivedPacket* m) {
  m->source = static_cast<std::uint32_t>(r.source);
  m->sequence = r.sequence;
  m->generation = TimeOf(start + r.generation);
  m->transmit = TimeOf(start + r.transmit);
  m->arrival = TimeOf(start + r.arrival);
  m->travel_time = r.travel_time_s;
  m->link_quality = r.link_quality;
  m->loss_probability = r.loss_probability;
  m->received_level_db = r.received_level_db;
  m->noise_level_db = r.noise_level_db;
  m->sinr_db = r.sinr_db;
  m->doppler_mps = r.doppler_mps;
  m->data.assign(r.data.begin(), r.data.end());
}

/// The inverse, for receiver `destination`; false when the payload has not the size of a packet.
/// The true distance is not in the message: a modem does not know it.
inline bool ReceptionOf(const auv_msgs::ReceivedPacket& m, int destination, TimeNs start,
                        acoustics::Reception* r) {
  if (m.data.size() != std::tuple_size<acoustics::Payload>::value) return false;
  *r = acoustics::Reception();
  r->source = static_cast<int>(m.source);
  r->destination = destination;
  r->sequence = m.sequence;
  r->generation = NsOf(m.generation) - start;
  r->transmit = NsOf(m.transmit) - start;
  r->arrival = NsOf(m.arrival) - start;
  r->travel_time_s = m.travel_time;
  r->link_quality = m.link_quality;
  r->loss_probability = m.loss_probability;
  r->received_level_db = m.received_level_db;
  r->noise_level_db = m.noise_level_db;
  r->sinr_db = m.sinr_db;
  r->doppler_mps = m.doppler_mps;
  std::copy(m.data.begin(), m.data.end(), r->data.begin());
  return true;
}

}  // namespace stg::nodes

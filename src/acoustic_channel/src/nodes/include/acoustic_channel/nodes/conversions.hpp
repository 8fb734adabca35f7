#pragma once

#include <auv_msgs/LinkState.h>
#include <auv_msgs/ReceivedPacket.h>

#include "acoustic_channel/channel/channel.hpp"
#include "auv_common/nodes/conversions.hpp"

namespace stg::nodes {

/// `start` is the clock time of the episode's step 0 [ns]. The times of the core count from it.
inline void SetReceivedPacket(const acoustics::Reception& r, TimeNs start,
                              auv_msgs::ReceivedPacket* m) {
  m->source = static_cast<std::uint32_t>(r.source);
  m->destination = r.destination;
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
  m->has_direction = static_cast<std::uint8_t>(r.has_direction);
  m->azimuth = r.azimuth_rad;
  m->elevation = r.elevation_rad;
  m->data.assign(r.payload.data, r.payload.data + r.payload.size);
}

/// The inverse, for node `receiver`. The payload is valid as long as the message. The message does
/// not contain the true distance, because a modem does not know it.
inline acoustics::Reception ReceptionOf(const auv_msgs::ReceivedPacket& m, int receiver,
                                        TimeNs start) {
  acoustics::Reception r;
  r.source = static_cast<int>(m.source);
  r.receiver = receiver;
  r.destination = m.destination;
  r.sequence = m.sequence;
  r.generation = NsOf(m.generation) - start;
  r.transmit = NsOf(m.transmit) - start;
  r.arrival = NsOf(m.arrival) - start;
  r.travel_time_s = m.travel_time;
  r.link_quality = m.link_quality;
  r.loss_probability = m.loss_probability;
  r.received_level_db = m.received_level_db;
  r.noise_level_db = m.noise_level_db;
  r.sinr_db = m.sinr_db;
  r.doppler_mps = m.doppler_mps;
  r.has_direction = m.has_direction != 0;
  r.azimuth_rad = m.azimuth;
  r.elevation_rad = m.elevation;
  r.payload = acoustics::ViewOf(m.data);
  return r;
}

/// Writes the numbers of a link, but not its nodes.
inline void SetLinkState(const acoustics::LinkStatistics& s, auv_msgs::LinkState* m) {
  m->distance = s.distance_m;
  m->quality = s.quality;
  m->loss_probability = s.loss_probability;
  m->delay = s.delay_s;
  m->age = s.age_s;
  m->average_age = s.average_age_s;
  m->peak_age = s.peak_age_s;
  m->delivered = static_cast<std::uint32_t>(s.delivered);
  m->dropped = static_cast<std::uint32_t>(s.dropped);
  m->last_drop_reason = static_cast<std::uint8_t>(s.last_drop);
}

}  // namespace stg::nodes

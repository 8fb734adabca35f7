#include "stg_agent/search/search_memory.hpp"

#include <algorithm>
#include <cmath>

namespace stg::agent {

SearchMemory::SearchMemory(const AgentModel& model)
    : map_(model),
      period_(static_cast<TimeNs>(std::llround(model.sensing.period_s * 1e9))),
      pings_(model.sensing.pings()),
      heard_(static_cast<std::size_t>(model.run.agents)) {}

void SearchMemory::Start(const dynamics::Cue& cue) {
  cue_ = cue;
  map_.Start(cue);
  detected_ = asked_ = answered_ = false;
  now_ = 0;
  plan = SearchPlan();
  for (Heard& heard : heard_) heard = Heard();
}

void SearchMemory::Detect(const dynamics::Detection& detection) {
  if (detected_ && detection.stamp <= detection_.stamp) return;
  detection_ = detection;
  detected_ = true;
}

void SearchMemory::Update(TimeNs now, const Vec3<double>& p_WB, const NeighbourTable& neighbours) {
  now_ = now;
  map_.Advance(now);
  for (const int id : neighbours.known()) {
    Hear(neighbours.state(id), &heard_[static_cast<std::size_t>(id)]);
  }
  const bool found = detected_;
  if (found) map_.Find(detection_);
  detected_ = false;
  if (pings_) answered_ = answered_ || found;
  const bool looks = period_ <= 0 || now % period_ == 0;
  if (looks && (pings_ || !found)) LookInVain(p_WB);
}

void SearchMemory::LookInVain(const Vec3<double>& p_WB) {
  if (!pings_) {
    map_.LookInVain(p_WB);
    return;
  }
  if (asked_ && !answered_) map_.LookInVain(p_asked_);
  asked_ = true;
  answered_ = false;
  p_asked_ = p_WB;
}

void SearchMemory::Hear(const NeighbourState& packet, Heard* heard) {
  if (packet.generation <= heard->generation) return;
  heard->generation = packet.generation;
  if (packet.target != cue_.target) return;
  const bool stale = !packet.sightings.empty() && packet.sightings[0].stamp <= heard->sighting &&
                     packet.generation - packet.sightings[0].stamp > 2 * period_;
  if (packet.sightings.empty() || stale) {
    map_.LookInVain(packet.p_W);
    return;
  }
  // Newest first. Sightings of earlier packets have been used already.
  const TimeNs taken = heard->sighting;
  for (const dynamics::Detection& sighting : packet.sightings) {
    if (sighting.stamp <= taken) continue;
    map_.Find(sighting);
    heard->sighting = std::max(heard->sighting, sighting.stamp);
  }
}

}  // namespace stg::agent

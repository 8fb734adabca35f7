#pragma once

#include <memory>

#include "acoustic_channel/channel/channel.hpp"
#include "stg_agent/stations/station.hpp"

namespace stg::agent {

/// Is called with where the stations are.
class StationObserver {
 public:
  virtual ~StationObserver() = default;
  /// After each Step: where station `station` truly is then.
  virtual void OnStation(int station, TimeNs t, const Station& state) = 0;
};

/// A channel between AUVs, in whose water the stations of the model live, too, and the transponders
/// of targets that AUVs ping (sensing.ranging): the scenario's channel between all members of the
/// network, of which the callers see the AUVs. Stations hear, move and send at each decision by
/// themselves; so do modems ping. Step takes the motion of the targets after that of the AUVs, if
/// bodies() is more than nodes(). Without stations and pings it is the scenario's channel.
/// @param sensing as it truly is @param observer of the stations, or null; outlives the channel
std::unique_ptr<acoustics::Channel> MakeStationChannel(const AgentModel& model,
                                                       const acoustics::ChannelConfig& channel,
                                                       const dynamics::SensingConfig& sensing,
                                                       const acoustics::LineOfSight& line_of_sight,
                                                       StationObserver* observer = nullptr);

}  // namespace stg::agent

#pragma once

#include <memory>

#include "acoustic_channel/channel/channel.hpp"
#include "stg_agent/stations/station.hpp"

namespace stg::agent {

/// Receives the positions of the stations.
class StationObserver {
 public:
  virtual ~StationObserver() = default;
  /// Called after each Step with the true state of a station.
  virtual void OnStation(int station, TimeNs t, const Station& state) = 0;
};

/// A channel between AUVs that also contains the model's stations and the transponders of targets
/// that AUVs ping (sensing.ranging). Callers see only the AUVs of this network. Stations receive,
/// move and send at each decision by themselves, and modems ping by themselves. The modems of AUVs
/// measure directions if the model says so. If bodies() is more than nodes(), Step takes the motion
/// of the targets after that of the AUVs. Without stations, pings and directions it is the
/// scenario's channel.
/// @param sensing true sensing @param observer of the stations, or null; must outlive the channel
std::unique_ptr<acoustics::Channel> MakeStationChannel(const AgentModel& model,
                                                       const acoustics::ChannelConfig& channel,
                                                       const dynamics::SensingConfig& sensing,
                                                       const acoustics::LineOfSight& line_of_sight,
                                                       StationObserver* observer = nullptr);

}  // namespace stg::agent

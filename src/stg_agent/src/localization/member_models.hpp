#pragma once

#include <vector>

#include "auv_common/numbers/attitude.hpp"
#include "stg_agent/agent_config.hpp"
#include "stg_agent/localization/joint_filter.hpp"

/// What an AUV's model of the network means for the joint filter.
namespace stg::agent {

/// Initial positions of the stations: beacons as charted, crafts at the surface.
inline std::vector<Vec3<double>> ChartOf(const AgentModel& s) {
  std::vector<Vec3<double>> chart;
  for (const auto& at : s.stations.beacons) chart.push_back({at[0], at[1], at[2]});
  for (const auto& at : s.stations.crafts) {
    chart.push_back({at[0], at[1], s.channel.physical.water.surface_z_m});
  }
  return chart;
}

/// How well the stations know their positions.
inline std::vector<AnchorModel> AnchorsOf(const AgentModel& s) {
  std::vector<AnchorModel> anchors;
  for (int k = 0; k < s.stations.count(); ++k) {
    anchors.push_back(s.stations.is_craft(k)
                          ? AnchorModel{s.stations.gps_std_m, s.stations.gps_memory_s, true}
                          : AnchorModel{s.stations.survey_std_m, 0.0, false});
  }
  return anchors;
}

/// What an AUV assumes of the clocks.
inline ClockModel ClocksOf(const AgentModel& s) {
  return {s.localization.clocks == Clocks::kEstimated && !s.pings_members(),
          s.channel.physical.modem.clock_offset_std_s,
          1e-6 * s.channel.physical.modem.clock_drift_std_ppm};
}

/// What an AUV assumes of all headings. It needs them if its modem measures directions.
/// @param self index of the member of the network
inline HeadingModel HeadingOf(const AgentModel& s, int self) {
  const double rad = kPi / 180.0;
  return {s.measures_directions() && self < s.run.agents, s.navigation.heading_std_deg * rad,
          s.navigation.gyro_walk_deg_per_sqrt_h * rad / 60.0};
}

}  // namespace stg::agent

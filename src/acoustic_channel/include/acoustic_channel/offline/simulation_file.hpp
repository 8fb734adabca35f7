#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "acoustic_channel/channel_config.hpp"
#include "acoustic_channel/offline/track.hpp"
#include "acoustic_channel/offline/traffic.hpp"
#include "auv_common/config/run_config.hpp"

namespace stg::acoustics {

/// A node of a network that is simulated offline.
struct SimulatedNode {
  int id = 0;
  Track track = Track::Line({}, {});
  std::string track_file;  ///< as the file names it; empty: there is none
  double joins_s = 0.0;
  double leaves_s = 0.0;  ///< 0: it stays
};

/// A network with its motion and traffic.
struct SimulationFile {
  double duration_s = 0.0;
  double step_s = 0.1;  ///< in which positions are updated and models without a clock of their own
                        ///< take packets
  std::uint64_t seed = 0;
  ChannelConfig channel;
  std::vector<SimulatedNode> nodes;  ///< by ascending id
  std::vector<TrafficSpec> traffic;

  /// The run of the channel.
  RunConfig Run() const;
};

/// Reads the file that docs/simulate.md describes; tracks lie relative to it. Throws UserError with
/// file, line and key for unknown keys and invalid values.
SimulationFile LoadSimulation(const std::string& path);

}  // namespace stg::acoustics

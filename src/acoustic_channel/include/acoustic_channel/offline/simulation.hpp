#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "acoustic_channel/channel/packet_observer.hpp"
#include "acoustic_channel/offline/simulation_file.hpp"
#include "acoustic_channel/offline/traffic.hpp"

namespace stg::acoustics {

/// Results of a simulated network. Nodes are indices. A packet counts once for each receiver,
/// except in `offered` and `transmitted`.
struct SimulationSummary {
  struct Receiver {
    std::uint64_t delivered = 0;
    double throughput = 0.0;  ///< share of time with the reception of delivered packets
  };
  struct Link {
    int source = 0, destination = 0;
    std::uint64_t delivered = 0;
    double average_age_s = 0.0, peak_age_s = 0.0;
  };
  double duration_s = 0.0;
  std::uint64_t offered = 0;      ///< packets given to modems
  std::uint64_t transmitted = 0;  ///< packets that left them
  std::uint64_t expected = 0;     ///< receivers of all packets that left
  std::uint64_t delivered = 0;
  std::uint64_t in_flight = 0;  ///< sent, but without a fate at the end
  DropCounts drops{};
  std::vector<Receiver> receivers;  ///< by node
  std::vector<Link> links;          ///< by source, then destination
  std::vector<double> energy_j;     ///< by node
};

/// A network offline. Time advances in steps. At each step, positions and presence are set, and the
/// packets since the last step go to the modems: in a model with continuous time, each at its own
/// time; otherwise at the end of the step, and only the newest packet of a node.
class Simulation {
 public:
  /// @param log gets every packet's reports; null: none. It must live as long as this object.
  Simulation(const SimulationFile& file, PacketObserver* log);
  ~Simulation();

  /// Runs a step. False: the end is reached.
  bool Step();
  double time_s() const { return Seconds(now_); }

  /// Results up to now, after at least one step.
  SimulationSummary Summary() const;

 private:
  class Tally;
  void Place();
  void Offer();

  SimulationFile file_;
  std::unique_ptr<Tally> tally_;
  std::unique_ptr<Channel> channel_;
  Traffic traffic_;
  TimeNs end_, step_period_, now_ = -1;  ///< now: of the last step
  std::uint32_t step_ = 0;
  std::vector<Vec3<double>> p_W_, v_W_;
  std::vector<char> present_;
  std::vector<stg::acoustics::Offer> offers_;
  std::vector<Transmission> transmissions_;
  std::vector<Reception> receptions_;
  std::vector<std::uint8_t> payload_;
};

}  // namespace stg::acoustics

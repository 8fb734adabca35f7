#include "acoustic_channel/offline/simulation_file.hpp"
#include "target.hpp"

/// A network for an offline simulation.
bool stg::fuzz::RunNetwork(const std::string& bytes) {
  return LoadAsFile(bytes, [](const std::string& path) {
    const acoustics::SimulationFile file = acoustics::LoadSimulation(path);
    Require(!file.nodes.empty() && file.duration_s > 0.0 && file.step_s > 0.0,
            "a network of nothing");
  });
}

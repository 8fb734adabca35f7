#include "auv_dynamics/vehicle/vehicle_set.hpp"

#include <algorithm>
#include <map>
#include <string>

namespace stg::dynamics {

VehicleSet::VehicleSet(const VehicleConfig& config, int vehicles) {
  std::map<std::string, const Vehicle*> known;
  for (int i = 0; i < vehicles; ++i) {
    const auto [kind, is_new] = known.try_emplace(config.model_of(i));
    if (is_new) {
      kinds_.push_back(Vehicles().Make(kind->first, config.kinds, config));
      kind->second = kinds_.back().get();
    }
    of_.push_back(kind->second);
  }
  for (const auto& kind : kinds_) {
    command_size_ = std::max(command_size_, kind->actuators().size());
    internal_size_ = std::max(internal_size_, static_cast<std::size_t>(kind->internal_size()));
  }
}

}  // namespace stg::dynamics

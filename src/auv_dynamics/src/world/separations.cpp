#include "auv_dynamics/world/separations.hpp"

namespace stg::dynamics {

Separations::Separations(int vehicles, double contact_m)
    : n_(vehicles),
      contact_m_(contact_m),
      distances_(static_cast<size_t>(vehicles * vehicles), Pack(0.0)) {}

void Separations::Measure(const std::vector<VehicleState<Pack>>& vehicles) {
  const Pack contact(contact_m_);
  colliding_pairs_ = Pack(0.0);
  smallest_ = Pack(1e9);
  for (int i = 0; i < n_; ++i) {
    for (int j = i + 1; j < n_; ++j) {
      const Pack d =
          Norm(vehicles[static_cast<size_t>(j)].p_WB - vehicles[static_cast<size_t>(i)].p_WB);
      distances_[static_cast<size_t>(i * n_ + j)] = d;
      distances_[static_cast<size_t>(j * n_ + i)] = d;
      colliding_pairs_ += Select(d < contact, Pack(1.0), Pack(0.0));
      smallest_ = Min(smallest_, d);
    }
  }
}

}  // namespace stg::dynamics

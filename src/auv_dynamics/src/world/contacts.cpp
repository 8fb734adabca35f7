#include "auv_dynamics/world/contacts.hpp"

namespace stg::dynamics {

Contacts::Contacts(const ContactConfig& config, int vehicles, double radius_m)
    : config_(config), radius_m_(radius_m), forces_(static_cast<size_t>(vehicles)) {}

void Contacts::Update(const std::vector<VehicleState<Pack>>& vehicles,
                      const Separations<Pack>& separations) {
  const double reach = 2.0 * radius_m_;
  const double k = config_.softness_m;
  for (auto& f : forces_) f = {};
  for (size_t i = 0; i < vehicles.size(); ++i) {
    for (size_t j = i + 1; j < vehicles.size(); ++j) {
      const Pack& d = separations.distance(static_cast<int>(i), static_cast<int>(j));
      // Beyond 40 softness lengths the softplus is below 1e-17 of a length, so it is set to zero.
      // Each lane decides this for itself, so its result does not depend on other lanes.
      const auto near = d < Pack(reach + 40.0 * k);
      if (!Any(near)) continue;
      const Pack x = (Pack(reach) - d) * Pack(1.0 / k);
      const Pack softplus = Max(x, Pack(0.0)) + Log1p(Exp(-Abs(x)));
      const Pack force = Select(near, Pack(config_.stiffness * k) * softplus, Pack(0.0));
      const Vec3<Pack> away = (vehicles[i].p_WB - vehicles[j].p_WB) * (force / Max(d, Pack(1e-9)));
      forces_[i] += away;
      forces_[j] += -away;
    }
  }
}

}  // namespace stg::dynamics

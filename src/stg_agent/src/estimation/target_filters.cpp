#include <limits>

#include "auv_dynamics/sensing/target_sensor.hpp"
#include "filters.hpp"

namespace stg::agent {

FilterRegistry& TargetFilters() {
  static FilterRegistry registry("target filter", {
                                                      {"kalman", MakeKalmanFilter},
                                                      {"measurements", MakeMeasurementFilter},
                                                  });
  return registry;
}

PacketLayout LayoutOf(const AgentModel& model) {
  return TargetFilters().Make(model.track.filter, model, 0)->layout();
}

std::optional<config::Violation> FindFilterConflict(const AgentModel& model) {
  const auto filter = TargetFilters().Make(model.track.filter, model, 0);
  const auto sensor =
      dynamics::TargetSensors().Make(model.sensing.sensor, model.sensing.sensors, model.sensing);
  if (filter->Takes(sensor->kind(), model.sensing.relative().ambiguous)) return {};
  return config::Violation{{"track.filter", "sensing.sensor"},
                           "this filter has no use for what this sensor measures"};
}

double Covariance3::SquaredNorm(const Vec3<double>& e) const {
  const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
  const double d = xx * zz - xz * xz, f = xy * xz - xx * yz, g = xx * yy - xy * xy;
  const double det = xx * a + xy * b + xz * c;
  if (!(det > 0.0)) return std::numeric_limits<double>::infinity();
  return (e.x * (a * e.x + b * e.y + c * e.z) + e.y * (b * e.x + d * e.y + f * e.z) +
          e.z * (c * e.x + f * e.y + g * e.z)) /
         det;
}

}  // namespace stg::agent

#include "auv_dynamics/targets/target_motion.hpp"

namespace stg::dynamics {
namespace {

/// The paper's target: it moves straight on. At a wall the position is clamped, and this component
/// of the velocity is reversed.
class ConstantVelocity : public TargetMotion {
 public:
  explicit ConstantVelocity(const MotionSetup& setup)
      : dt_(setup.dt_s), half_extent_(setup.half_extent_m) {}

  void Step(const EpisodeClocks&, const std::vector<VehicleState<Pack>>&,
            std::vector<TargetState<Pack>>* targets) override {
    const Pack h(dt_), limit(half_extent_);
    for (TargetState<Pack>& t : *targets) {
      t.p_WT += t.v_WT * h;
      t.v_WT.x = Select(Abs(t.p_WT.x) > limit, -t.v_WT.x, t.v_WT.x);
      t.v_WT.y = Select(Abs(t.p_WT.y) > limit, -t.v_WT.y, t.v_WT.y);
      t.v_WT.z = Select(Abs(t.p_WT.z) > limit, -t.v_WT.z, t.v_WT.z);
      t.p_WT = Clip(t.p_WT, -half_extent_, half_extent_);
    }
  }

 private:
  double dt_, half_extent_;
};

std::unique_ptr<TargetMotion> MakeConstantVelocity(const MotionSetup& setup) {
  return std::make_unique<ConstantVelocity>(setup);
}

}  // namespace

MotionRegistry::Entry ConstantVelocityEntry() {
  return {"constant_velocity", MakeConstantVelocity};
}

}  // namespace stg::dynamics

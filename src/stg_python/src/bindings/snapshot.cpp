#include <limits>

#include "acoustic_channel/models/range.hpp"
#include "bound_env.hpp"

namespace stg::python {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Rows of a numpy array of doubles.
class Table {
 public:
  Table(int rows, int columns) : array_({rows, columns}), to_(array_.mutable_data()) {}

  void Add(const Vec3<double>& v) {
    Add(v.x);
    Add(v.y);
    Add(v.z);
  }
  void Add(double number) { *to_++ = number; }
  const py::array_t<double>& array() const { return array_; }

 private:
  py::array_t<double> array_;
  double* to_;
};

/// Quality of the link from AUV j to AUV i, in [0, 1]; 0 if i has received nothing from j.
double Quality(const env::VectorEnv& envs, int env, int i, int j) {
  const Scenario& s = envs.scenario(env);
  if (i == j) return 0.0;
  if (s.mode == InformationMode::kTruth) {
    const double distance = Norm(envs.vehicle(env, j).p_WB - envs.vehicle(env, i).p_WB);
    return acoustics::RangeQuality(distance, s.channel.range_m);
  }
  const agent::AgentView view = envs.agent(env, i);
  return view.neighbours().knows(j) ? view.sight(j).link_quality : 0.0;
}

}  // namespace

py::dict BoundEnv::Snapshot(int env) const {
  const Use use(this);
  const EnvPool::Place place = at(env);
  const env::VectorEnv& envs = place.envs;
  const int e = place.env, n = agents_, targets = envs.scenario(place.env).world.target.count;
  Table position(n, 3), velocity(n, 3), rpy(n, 3), estimate(n, 3), links(n, n), tracking(n, 4);
  for (int i = 0; i < n; ++i) {
    const dynamics::VehicleState<double> v = envs.vehicle(e, i);
    const agent::Knowledge<double> known = envs.knowledge(e, i);
    const task::Tracking<double> true_tracking = envs.tracking(e, i);
    position.Add(v.p_WB);
    velocity.Add(v.v_WB);
    rpy.Add(RpyOf(v.trig));
    const bool blind = known.lost > 0.5;
    estimate.Add(blind ? Vec3<double>{kNone, kNone, kNone} : known.p_WB + known.r_BT_W);
    tracking.Add(true_tracking.distance);
    tracking.Add(true_tracking.error);
    tracking.Add(true_tracking.confidence);
    tracking.Add(true_tracking.lost);
    for (int j = 0; j < n; ++j) links.Add(Quality(envs, e, i, j));
  }
  Table target_position(targets, 3), target_velocity(targets, 3);
  for (int k = 0; k < targets; ++k) {
    const dynamics::TargetState<double> t = envs.target(e, k);
    target_position.Add(t.p_WT);
    target_velocity.Add(t.v_WT);
  }
  py::dict shot;
  shot["time"] = 1e-9 * static_cast<double>(envs.time(e));
  shot["step"] = envs.step(e);
  shot["position"] = position.array();
  shot["velocity"] = velocity.array();
  shot["rpy"] = rpy.array();
  shot["estimate"] = estimate.array();
  shot["tracking"] = tracking.array();
  shot["links"] = links.array();
  shot["target_position"] = target_position.array();
  shot["target_velocity"] = target_velocity.array();
  return shot;
}

}  // namespace stg::python

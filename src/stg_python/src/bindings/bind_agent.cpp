#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acoustic_channel/access/medium_access.hpp"
#include "arrays.hpp"
#include "auv_common/error.hpp"
#include "auv_dynamics/control/control.hpp"
#include "bind.hpp"
#include "stg_agent/agent/agent.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::python {
namespace {

using Triple = std::array<double, 3>;

Vec3<double> VectorOf(const Triple& v) { return {v[0], v[1], v[2]}; }
Triple TripleOf(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

/// Getter of a Python property for a vector member of an object.
template <class Object>
auto Get(Vec3<double> Object::*member) {
  return [member](const Object& o) { return TripleOf(o.*member); };
}
template <class Object>
auto Set(Vec3<double> Object::*member) {
  return [member](Object& o, const Triple& v) { o.*member = VectorOf(v); };
}

agent::NeighbourState Decode(const agent::PacketCodec& codec, const py::bytes& data, TimeNs now) {
  const std::string_view bytes = data;
  return codec.Decode(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), now);
}

py::bytes Bytes(const agent::Packet& packet) {
  return {reinterpret_cast<const char*>(packet.data()), packet.size()};
}

py::dict EstimateOf(const agent::TargetEstimate& e) {
  py::dict all;
  all["stamp"] = e.stamp;
  all["p_WT"] = TripleOf(e.p_WT);
  all["v_WT"] = TripleOf(e.v_WT);
  all["position_std_m"] = e.position_std_m();
  return all;
}

dynamics::Detection DetectionOf(TimeNs stamp, const Triple& p_WT, double std_m, int target) {
  dynamics::Detection d;
  d.stamp = stamp;
  d.target = target;
  d.p_WT = VectorOf(p_WT);
  d.std_m = std_m;
  if (!std::isfinite(Dot(d.p_WT, d.p_WT)) || !std::isfinite(std_m) || std_m < 0.0) {
    throw py::value_error("detection: not finite, or a negative standard deviation");
  }
  return d;
}

/// An agent, and the turns at which its modem may send.
struct BoundAgent {
  BoundAgent(const Scenario& scenario, int id)
      : mind(Checked(scenario, id).model(), id), turns(scenario.channel, scenario.run) {}

  static const Scenario& Checked(const Scenario& s, int id) {
    if (id < 0 || id >= s.run.agents) {
      throw py::value_error("id: " + std::to_string(id) + ", there are " +
                            std::to_string(s.run.agents) + " AUVs");
    }
    if (s.mode == InformationMode::kTruth) {
      throw UserError("scenario '" + s.run.name +
                      "' has the mode truth, but an agent has only its own knowledge; set "
                      "mode=acoustic");
    }
    return s;
  }

  agent::Agent mind;
  acoustics::Turns turns;
  std::vector<double> action;  ///< executed action of the last act
};

void Reset(BoundAgent& a, std::int64_t seed, std::uint32_t episode,
           const std::optional<Triple>& cue, double cue_std_m) {
  if (seed < 0) throw py::value_error("seed: " + std::to_string(seed) + " is not in [0, 2^63)");
  dynamics::Cue c;
  c.target = cue ? a.mind.target() : -1;
  if (cue) c.p_WT = VectorOf(*cue);
  c.std_m = cue_std_m;
  a.mind.Reset(episode, c);
  a.turns.Reset(static_cast<std::uint64_t>(seed), 0);
}

void Receive(BoundAgent& a, const py::bytes& data, TimeNs arrival) {
  const std::string_view bytes = data;
  acoustics::Reception r;
  r.receiver = a.mind.id();
  r.arrival = arrival;
  r.payload = {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
  a.mind.Receive(r);
}

py::array_t<float> Observe(BoundAgent& a, TimeNs stamp, const Triple& p_WB,
                           const std::array<double, 4>& q_WB, const Triple& v_WB_B,
                           const Triple& w_WB_B) {
  dynamics::NavState nav;
  nav.stamp = stamp;
  nav.p_WB = VectorOf(p_WB);
  std::copy(q_WB.begin(), q_WB.end(), nav.q_WB);
  nav.v_WB_B = VectorOf(v_WB_B);
  nav.w_WB_B = VectorOf(w_WB_B);
  py::array_t<float> observation(a.mind.model().observation_size());
  a.mind.Observe(nav, observation.mutable_data());
  return observation;
}

py::dict Act(BoundAgent& a, const py::handle& action) {
  const agent::AgentModel& s = a.mind.model();
  const Floats floats = RequireFloats(action, "action", {s.control.action_size()});
  const auto wanted = py::array_t<float, py::array::c_style | py::array::forcecast>(floats.array);
  const agent::AgentOutput out = a.mind.Act(wanted.data());
  a.action.assign(out.action, out.action + s.control.action_size());
  const dynamics::Wrench<double> wrench = dynamics::ScaleWrench(s.vehicle, out.fraction);
  py::dict all;
  all["cmd_vel"] = TripleOf(out.cmd_vel_W);
  all["force"] = TripleOf(wrench.force);
  all["moment"] = TripleOf(wrench.moment);
  return all;
}

/// The agent's view of its task, with the field names of auv_msgs/TaskState.
py::dict Task(const BoundAgent& a) {
  const agent::TaskView task = a.mind.task();
  const agent::Knowledge<double>& k = a.mind.knowledge();
  const agent::AgentView view = a.mind.view();
  double age = std::numeric_limits<double>::infinity();
  for (const int id : view.neighbours().known()) age = std::min(age, view.sight(id).age_s);
  py::dict all;
  all["z_track"] = task.z_track;
  all["phase"] = task.phase;
  all["quality"] = task.quality;
  all["graph_summary"] = task.graph;
  all["role"] = task.role;
  all["action"] = a.action;
  all["target"] = a.mind.target();
  all["absent"] = !a.mind.present();
  all["target_known"] = a.mind.belief().started;
  all["target_std"] = a.mind.estimate().position_std_m();
  all["target_distance"] = k.distance;
  all["tracking_error"] = k.error;
  all["confidence"] = k.confidence;
  all["neighbours"] = view.neighbours().known();
  all["neighbour_age"] = std::isfinite(age) ? age : 0.0;
  return all;
}

}  // namespace

void BindAgent(py::module_& module) {
  using agent::NeighbourState;
  py::class_<NeighbourState>(
      module, "NeighbourState",
      "State that an AUV sends to its neighbours. World axes (ENU), times in [ns].")
      .def(py::init<>())
      .def_readwrite("source", &NeighbourState::source, "Index of the AUV, from 0.")
      .def_readwrite("generation", &NeighbourState::generation, "Time of this state [ns].")
      .def_property("p_W", Get(&NeighbourState::p_W), Set(&NeighbourState::p_W), "Position [m].")
      .def_property("v_W", Get(&NeighbourState::v_W), Set(&NeighbourState::v_W),
                    "Velocity over ground [m/s].")
      .def_readwrite("confidence", &NeighbourState::confidence, "Eq. 13, [0, 1].")
      .def_readwrite("tracking_error", &NeighbourState::tracking_error, "Eq. 12 [m].")
      .def_readwrite("phase", &NeighbourState::phase, "0 search, 1 approach, 2 stable, 3 lost.")
      .def_readwrite("link_quality", &NeighbourState::link_quality,
                     "Mean quality of the links on which the AUV receives, [0, 1].")
      .def_readwrite("has_target", &NeighbourState::has_target,
                     "False: the AUV has no target estimate, and the fields below have no meaning.")
      .def_readwrite("target", &NeighbourState::target, "Index of the target.")
      .def_readwrite("target_stamp", &NeighbourState::target_stamp,
                     "Time of the target estimate [ns].")
      .def_property("p_WT", Get(&NeighbourState::p_WT), Set(&NeighbourState::p_WT),
                    "Estimated target position [m].")
      .def_property("v_WT", Get(&NeighbourState::v_WT), Set(&NeighbourState::v_WT),
                    "Estimated target velocity [m/s].")
      .def_readwrite("target_std", &NeighbourState::target_std,
                     "Standard deviation of each component of p_WT [m].")
      .def_readonly("saturated", &NeighbourState::saturated,
                    "True: a value was out of range and is clipped; set by encode.");

  py::class_<agent::PacketCodec>(module, "PacketCodec", "The 32-byte packet of the agents.")
      .def(py::init([](const Scenario& s) { return agent::PacketCodec(s.model()); }),
           py::arg("scenario"))
      .def(
          "encode",
          [](const agent::PacketCodec& c, const NeighbourState& s) { return Bytes(c.Encode(s)); },
          py::arg("state"), "32 bytes; raises ValueError for numbers that are not finite.")
      .def("decode", &Decode, py::arg("data"), py::arg("now"),
           "State in `data`, for a receiver whose clock is at `now` [ns]; raises UserError for "
           "damaged data.");

  py::class_<agent::TargetTrack>(
      module, "TargetTrack",
      "Constant-velocity Kalman filter of one target. World axes, times [ns].")
      .def(py::init([](const Scenario& s) { return agent::TargetTrack(s.model()); }),
           py::arg("scenario"))
      .def("clear", &agent::TargetTrack::Clear)
      .def(
          "start",
          [](agent::TargetTrack& t, const Triple& p_WT, double std_m, TimeNs stamp) {
            t.Start(VectorOf(p_WT), std_m, stamp);
          },
          py::arg("p_WT"), py::arg("std_m"), py::arg("stamp"),
          "Starts the track at a position [m] with a standard deviation [m] per component.")
      .def("predict", &agent::TargetTrack::Predict, py::arg("time"),
           "Carries the estimate forward; an earlier time changes nothing.")
      .def(
          "detect",
          [](agent::TargetTrack& t, TimeNs stamp, const Triple& p_WT, double std_m) {
            t.Detect(DetectionOf(stamp, p_WT, std_m, 0));
          },
          py::arg("stamp"), py::arg("p_WT"), py::arg("std_m"),
          "Updates the track with an own detection.")
      .def(
          "fuse",
          [](agent::TargetTrack& t, TimeNs stamp, const Triple& p_WT, const Triple& v_WT,
             double std_m) {
            t.Fuse({stamp, VectorOf(p_WT), VectorOf(v_WT), std_m});
          },
          py::arg("stamp"), py::arg("p_WT"), py::arg("v_WT"), py::arg("std_m"),
          "Updates the track with an estimate that another AUV shared.")
      .def_property_readonly("started", &agent::TargetTrack::started)
      .def_property_readonly(
          "estimate", [](const agent::TargetTrack& t) { return EstimateOf(t.estimate()); },
          "{stamp [ns], p_WT [m], v_WT [m/s], position_std_m}.");

  py::class_<BoundAgent>(module, "Agent", "The agent of one AUV, as the C++ node runs it.")
      .def(py::init<const Scenario&, int>(), py::arg("scenario"), py::arg("id"))
      .def("reset", &Reset, py::arg("seed") = 0, py::arg("episode") = 0,
           py::arg("cue") = py::none(), py::arg("cue_std_m") = 0.0,
           "Starts an episode without any knowledge. `cue`: assumed position of the target at time "
           "0 [m].")
      .def(
          "detect",
          [](BoundAgent& a, TimeNs stamp, const Triple& p_WT, double std_m, int target) {
            a.mind.Detect(DetectionOf(stamp, p_WT, std_m, target));
          },
          py::arg("stamp"), py::arg("p_WT"), py::arg("std_m"), py::arg("target") = 0,
          "An own detection; the newest before the next observe counts.")
      .def(
          "follow", [](BoundAgent& a, int target) { a.mind.view().Follow(target); },
          py::arg("target"),
          "Follows another target from the next observe on. It needs task.assignment free;\n"
          "otherwise nothing happens.")
      .def(
          "add_cue",
          [](BoundAgent& a, int target, const Triple& p_WT, double std_m) {
            dynamics::Cue cue;
            cue.target = target;
            cue.p_WT = VectorOf(p_WT);
            cue.std_m = std_m;
            a.mind.AddCue(cue);
          },
          py::arg("target"), py::arg("p_WT"), py::arg("std_m"),
          "Assumed position of another target at time 0 [m]; call it after reset.")
      .def_property_readonly(
          "present", [](const BoundAgent& a) { return a.mind.present(); },
          "False: the AUV has left the swarm, at the time of the last observe.")
      .def("receive", &Receive, py::arg("data"), py::arg("arrival"),
           "A packet from the modem; one that does not decode is counted and ignored.")
      .def("observe", &Observe, py::arg("stamp"), py::arg("p_WB"), py::arg("q_WB"),
           py::arg("v_WB_B"), py::arg("w_WB_B"),
           "Brings all knowledge to `stamp` [ns]; returns the observation [observation_size].\n"
           "q_WB is w, x, y, z; velocities are in body axes (FLU).")
      .def("act", &Act, py::arg("action"),
           "Executes an action, once after each observe: {cmd_vel (world) [m/s], force [N] and\n"
           "moment [N m] (body)}.")
      .def("task", &Task,
           "The agent's estimates, by the names of the fields of auv_msgs/TaskState.")
      .def(
          "make_packet", [](const BoundAgent& a) { return Bytes(a.mind.MakePacket()); },
          "The packet that the agent gives to its modem: 32 bytes.")
      .def(
          "packet_due", [](BoundAgent& a, TimeNs stamp) { return a.turns.Due(a.mind.id(), stamp); },
          py::arg("stamp"), "Whether medium access allows a packet of this AUV in this step.")
      .def_property_readonly("id", [](const BoundAgent& a) { return a.mind.id(); })
      .def_property_readonly("target", [](const BoundAgent& a) { return a.mind.target(); })
      .def_property_readonly("lost", [](const BoundAgent& a) { return a.mind.lost(); })
      .def_property_readonly(
          "neighbours", [](const BoundAgent& a) { return a.mind.neighbours().known(); },
          "Indices of the neighbours from which the agent received lately.")
      .def_property_readonly("track",
                             [](const BoundAgent& a) { return EstimateOf(a.mind.estimate()); });
}

}  // namespace stg::python

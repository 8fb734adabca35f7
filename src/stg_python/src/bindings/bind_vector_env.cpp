#include <pybind11/stl.h>

#include <algorithm>
#include <optional>

#include "auv_common/error.hpp"
#include "bind.hpp"
#include "bound_env.hpp"

namespace stg::python {
namespace {

/// True if the resets follow the curriculum. Throws UserError if this is not decided, or without
/// effect.
bool FollowsCurriculum(const std::vector<Scenario>& mix, const std::optional<bool>& given) {
  const bool there = std::any_of(mix.begin(), mix.end(),
                                 [](const Scenario& s) { return s.world.reset.curriculum; });
  if (there && !given) {
    throw UserError(
        "reset.curriculum: the scenario has a curriculum. vector_env needs its option "
        "`curriculum`: True follows it in training, False starts all episodes at reset.stage. "
        "parallel_env has no training to follow; set reset.curriculum=false");
  }
  if (given.value_or(false) && !there) {
    throw UserError("curriculum: the scenario has none; reset.curriculum=true turns it on");
  }
  return given.value_or(false);
}

}  // namespace

void BindVectorEnv(py::module_& module) {
  module.attr("MIX_BLOCK") = env::kMixBlock;
  py::class_<BoundEnv>(module, "VectorEnv",
                       "Environments that write to arrays of the caller; see the package stg.")
      .def(py::init([](const std::vector<Scenario>& mix, int envs, int workers, std::uint64_t seed,
                       const std::optional<bool>& curriculum, bool stagger) {
             env::VectorEnvOptions options;
             options.envs = envs;
             options.seed = seed;
             options.curriculum = FollowsCurriculum(mix, curriculum);
             options.stagger = stagger;
             return std::make_unique<BoundEnv>(mix, options, workers);
           }),
           py::arg("mix"), py::arg("num_envs"), py::arg("workers") = 1, py::arg("seed") = 0,
           py::arg("curriculum") = py::none(), py::arg("stagger") = false)
      .def("bind", &BoundEnv::Bind, py::arg("arrays"),
           "Names the arrays that later calls write to.")
      .def("restart_at", &BoundEnv::RestartAt, py::arg("k"),
           "Starts the k-th episode of every environment.")
      .def("reseed", &BoundEnv::Reseed, py::arg("seed"),
           "Episodes that start from now on are drawn from this seed.")
      .def("reset_env", &BoundEnv::ResetEnv, py::arg("env"), py::arg("seed"),
           "Starts an episode of one environment; the others go on.")
      .def("step", &BoundEnv::Step, py::arg("actions"),
           "One decision; returns how many episodes it ended.")
      .def("step_agents", &BoundEnv::StepAgents, py::arg("actions"),
           "One decision of one environment, actions by the AUVs' names.")
      .def("decide", &BoundEnv::Decide, py::arg("name"), py::arg("privileged") = false,
           "Actions of a policy file or built-in controller.")
      .def("close", &BoundEnv::Close, "Frees everything; later calls raise RuntimeError.")
      .def("metrics", &BoundEnv::Metrics, py::arg("env"), "Metrics of the episode that ended last.")
      .def("snapshot", &BoundEnv::Snapshot, py::arg("env"), "The true states, for drawing.")
      .def("entities", &BoundEnv::Entities, py::arg("env"), py::arg("agent"),
           "An AUV's knowledge, as rows: the layout stg-2:entities.")
      .def("follow", &BoundEnv::Follow, py::arg("env"), py::arg("agent"), py::arg("target"),
           "An AUV follows another target from the next decision on.")
      .def("followed", &BoundEnv::followed, py::arg("env"), py::arg("agent"),
           "The target that an AUV follows.")
      .def("scenario", &BoundEnv::scenario, py::arg("env"), py::return_value_policy::copy)
      .def("seed", &BoundEnv::seed, py::arg("env"), "World seed of the present episode.")
      .def("round", &BoundEnv::round, py::arg("env"), "k of the present episode.")
      .def("episode_step", &BoundEnv::step, py::arg("env"),
           "Number of decisions made in the present episode.")
      .def_property_readonly("workers", &BoundEnv::workers);
}

}  // namespace stg::python

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "auv_common/config/files.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_dynamics/terrain/seascape.hpp"
#include "bind.hpp"
#include "stg_agent/policy/policy.hpp"
#include "stg_env/scenario/scenario.hpp"
#include "stg_env/task/critic_state.hpp"

namespace stg::python {
namespace {

namespace py = pybind11;

/// Converts the value of a key to a Python object.
struct Cast {
  py::object operator()(const double* x) const { return py::float_(*x); }
  py::object operator()(const int* x) const { return py::int_(*x); }
  py::object operator()(const std::int64_t* x) const { return py::int_(*x); }
  py::object operator()(const std::uint64_t* x) const { return py::int_(*x); }
  py::object operator()(const bool* x) const { return py::bool_(*x); }
  py::object operator()(const std::string* x) const { return py::str(*x); }
  py::object operator()(const config::EnumRef& x) const {
    return py::str(x.names[static_cast<std::size_t>(x.get())]);
  }
  py::object operator()(const config::NumbersRef& x) const {
    return py::cast(std::vector<double>(x.data, x.data + x.size));
  }
  py::object operator()(const config::Interval* x) const {
    return py::cast(std::vector<double>{x->lo, x->hi});
  }
  py::object operator()(const config::WholeNumbersRef& x) const { return py::cast(*x.list); }
  py::object operator()(const config::TextRef& x) const { return py::str(*x.text); }
  py::object operator()(const config::RowsRef& x) const { return py::cast(*x.rows); }
  py::object operator()(const config::NamesRef& x) const { return py::cast(*x.list); }
  py::object operator()(const config::NameOrFileRef& x) const { return py::str(*x.text); }
  py::object operator()(const config::DifferenceRef& x) const {
    const auto found = x.all->find(x.of->path);
    return found == x.all->end() ? py::object(py::none()) : py::str(found->second);
  }
};

py::object ToPython(const config::ValueRef& value) { return std::visit(Cast{}, value); }

/// All keys with their values.
py::dict Values(const Scenario& scenario) {
  Scenario copy = scenario;
  config::Table table;
  Describe(&copy, &table);
  py::dict values;
  for (const config::Field& field : table.fields()) {
    values[py::str(field.path)] = ToPython(field.value);
  }
  return values;
}

py::list Layout(const Scenario& scenario) {
  const agent::ObservationSpec spec(scenario.agent.observation);
  py::list blocks;
  for (int b = 0; b < agent::kBlockCount; ++b) {
    const auto block = static_cast<agent::Block>(b);
    if (spec.size(block) == 0) continue;
    const agent::BlockDescription& d = agent::kBlocks[b];
    blocks.append(py::make_tuple(d.name, spec.offset(block), spec.size(block), d.content));
  }
  return blocks;
}

/// Heights of the bottom of open water, on a grid over the region.
py::array_t<double> Bottom(const Scenario& s, int points) {
  if (!s.world.sea.open)
    throw UserError("scenario '" + s.run.name + "' has no open water (sea.open)");
  if (points < 2 || points > 4096) throw py::value_error("points: must be 2 to 4096");
  const double half = s.world.workspace.half_extent_m, step = 2.0 * half / (points - 1);
  const dynamics::Seascape sea(s.world.sea, half);
  py::array_t<double> heights({points, points});
  auto at = heights.mutable_unchecked<2>();
  for (int j = 0; j < points; ++j) {
    for (int i = 0; i < points; ++i) {
      at(j, i) = sea.terrain.Height(i * step - half, j * step - half);
    }
  }
  return heights;
}

}  // namespace

void BindScenario(py::module_& module) {
  module.def("scenario_folder", &config::ScenarioFolder, "Folder of the shipped scenarios.");
  module.def(
      "load_plugin", [](const std::string& library) { config::LoadPlugin(library, ""); },
      py::arg("library"),
      "Loads a shared library whose controllers, reward terms, ... can then be chosen by name. The "
      "key `plugins` of a scenario does the same.\n"
      "library: a path, or the name of a file that the system's loader finds. Raises UserError for "
      "a library that is missing, was built for another version, or adds a name that is taken.");
  py::class_<Scenario>(module, "Scenario", "Everything an episode depends on besides its seed.")
      .def_static(
          "load",
          [](const std::string& scenario, const std::string& condition,
             const std::vector<std::string>& overrides, const std::string& folder) {
            return LoadNamedScenario(folder.empty() ? config::ScenarioFolder() : folder, scenario,
                                     condition, overrides);
          },
          py::arg("scenario"), py::arg("condition") = "nominal",
          py::arg("overrides") = std::vector<std::string>(), py::arg("folder") = "",
          "Loads a shipped scenario by name, or a YAML file. `overrides`: \"key.path=value\" "
          "each.\n"
          "Raises UserError that names file, line and key.")
      .def_static(
          "from_yaml",
          [](const std::string& text) {
            return config::LoadText<Scenario>(text, "text", config::Unread::kPassOver);
          },
          py::arg("text"),
          "Reads a whole scenario file from text, such as the ROS parameter `/scenario`.")
      .def(
          "to_yaml", [](const Scenario& s) { return ToYaml(s); }, "Every key with its value.")
      .def("values", &Values, "{\"key.path\": value} of every key.")
      .def("__getitem__",
           [](const Scenario& s, const std::string& key) -> py::object {
             const py::dict values = Values(s);
             if (!values.contains(key)) throw py::key_error(key);
             return values[py::str(key)];
           })
      .def("bottom", &Bottom, py::arg("points") = 65,
           "Heights [points, points] of the bottom of open water, world z [m], on a grid from "
           "-half_extent_m to half_extent_m: rows from south to north, columns from west to east.\n"
           "Raises UserError where there is no open water, or where the bathymetry cannot be read.")
      .def("__repr__",
           [](const Scenario& s) {
             return "<stg.Scenario '" + s.run.name + "', " + std::to_string(s.run.agents) +
                    " AUVs>";
           })
      .def_property_readonly(
          "hash", [](const Scenario& s) { return ScenarioHash(s); },
          "Identifies the scenario in policy files.")
      .def_property_readonly("name", [](const Scenario& s) { return s.run.name; })
      .def_property_readonly("agents", [](const Scenario& s) { return s.run.agents; })
      .def_property_readonly("targets", [](const Scenario& s) { return s.world.target.count; })
      .def_property_readonly("action_size",
                             [](const Scenario& s) { return s.world.control.action_size(); })
      .def_property_readonly("observation_size",
                             [](const Scenario& s) { return s.agent.observation_size(); })
      .def_property_readonly(
          "state_size", [](const Scenario& s) { return task::CriticStateSize(s.run, s.world); })
      .def_property_readonly(
          "episode_steps", [](const Scenario& s) { return s.run.time.episode_steps; },
          "Decisions of an episode.")
      .def_property_readonly(
          "decision_dt_s", [](const Scenario& s) { return s.run.decision_dt_s(); },
          "Time between two decisions [s].")
      .def_property_readonly(
          "observation_layout",
          [](const Scenario& s) { return agent::ObservationLayout(s.agent.observation); },
          "Name of the layout, which policy files carry.")
      .def_property_readonly(
          "action_interface",
          [](const Scenario& s) { return agent::ActionInterfaceName(s.world.control.interface); },
          "\"velocity3\" or \"tau6\".")
      .def_property_readonly("observation_blocks", &Layout,
                             "[(name, first index, size, content)] of an observation.");
}

}  // namespace stg::python

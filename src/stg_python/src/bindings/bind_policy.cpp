#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "arrays.hpp"
#include "auv_common/parallel/worker_pool.hpp"
#include "bind.hpp"
#include "stg_agent/controllers/controller.hpp"
#include "stg_agent/policy/policy.hpp"
#include "stg_env/env/evaluation.hpp"
#include "stg_env/env/unread_keys.hpp"
#include "without_gil.hpp"

namespace stg::python {
namespace {

using agent::Policy;

Policy::Activation ActivationOf(const std::string& name) {
  if (name != "tanh" && name != "relu") {
    throw py::value_error("activation: must be tanh or relu, not '" + name + "'");
  }
  return name == "tanh" ? Policy::Activation::kTanh : Policy::Activation::kRelu;
}

using LayerPair = std::pair<Eigen::MatrixXf, Eigen::VectorXf>;

Policy MakePolicy(const std::vector<LayerPair>& layers, const Eigen::VectorXf& input_mean,
                  const Eigen::VectorXf& input_std, const std::string& observation_layout,
                  const std::string& action_interface, const std::string& activation,
                  float input_clip, const std::optional<Eigen::VectorXf>& log_std,
                  double action_scale, const std::string& id, const std::string& scenario_hash,
                  std::int64_t training_step, std::uint64_t seed,
                  const std::map<std::string, std::string>& metrics) {
  Policy::Parameters p;
  p.input_mean = input_mean;
  p.input_std = input_std;
  p.input_clip = input_clip;
  for (const auto& [weight, bias] : layers) p.layers.push_back({weight, bias});
  p.activation = ActivationOf(activation);
  const Eigen::Index actions = layers.empty() ? 0 : layers.back().second.size();
  p.log_std = log_std.value_or(Eigen::VectorXf::Zero(actions));
  p.metadata.id = id;
  p.metadata.observation_layout = observation_layout;
  p.metadata.action_interface = action_interface;
  p.metadata.action_scale = action_scale;
  p.metadata.scenario_hash = scenario_hash;
  p.metadata.training_step = training_step;
  p.metadata.seed = seed;
  p.metadata.metrics = metrics;
  return Policy(std::move(p));
}

py::dict Metadata(const Policy& policy) {
  const agent::PolicyMetadata& m = policy.metadata();
  py::dict all;
  all["id"] = m.id;
  all["observation_layout"] = m.observation_layout;
  all["action_interface"] = m.action_interface;
  all["action_scale"] = m.action_scale;
  all["scenario_hash"] = m.scenario_hash;
  all["training_step"] = m.training_step;
  all["seed"] = m.seed;
  all["metrics"] = m.metrics;
  return all;
}

py::dict Parameters(const Policy& policy) {
  const Policy::Parameters& p = policy.parameters();
  py::list layers;
  for (const Policy::Layer& layer : p.layers) {
    layers.append(py::make_tuple(layer.weight, layer.bias));
  }
  py::dict all;
  all["layers"] = layers;
  all["activation"] = p.activation == Policy::Activation::kTanh ? "tanh" : "relu";
  all["input_mean"] = p.input_mean;
  all["input_std"] = p.input_std;
  all["input_clip"] = p.input_clip;
  all["log_std"] = p.log_std;
  return all;
}

/// Mean actions [..., action_size] for observations [..., observation_size].
py::array_t<float> Mean(const Policy& policy, const py::handle& object) {
  if (!py::isinstance<py::array>(object))
    throw py::type_error("observations: expected a numpy array");
  const auto given = py::reinterpret_borrow<py::array>(object);
  Shape shape(given.shape(), given.shape() + given.ndim());
  if (shape.empty() || shape.back() != policy.observation_size()) {
    throw py::value_error("observations: expected shape (..., " +
                          std::to_string(policy.observation_size()) + "), not " + Text(shape));
  }
  const Floats floats = RequireFloats(object, "observations", shape);
  const auto rows = py::array_t<float, py::array::c_style | py::array::forcecast>(floats.array);
  if (FindNotFinite(rows.data(), rows.size()) >= 0) {
    throw py::value_error("observations: not finite");
  }
  shape.back() = policy.action_size();
  py::array_t<float> actions(shape);
  const float* from = rows.data();
  float* to = actions.mutable_data();
  const py::ssize_t count = rows.size() / policy.observation_size();
  const WithoutGil release;
  for (py::ssize_t r = 0; r < count; ++r) {
    policy.Mean(from + r * policy.observation_size(), to + r * policy.action_size());
  }
  return actions;
}

/// The same as the program `evaluate`: means and standard deviations over the episodes.
py::dict Evaluate(const std::string& policy, const Scenario& scenario, int episodes,
                  std::uint64_t seed, int workers, bool privileged,
                  const std::vector<std::string>& overrides) {
  if (episodes < 1) throw py::value_error("episodes: must be at least 1");
  if (workers < 1) throw py::value_error("workers: must be at least 1");
  task::MetricSummary summary;
  {
    const WithoutGil release;
    agent::Decider controller = agent::MakeDecider(policy, scenario.model());
    RefuseKeysOfTraining(overrides, "evaluate");
    env::RefuseUnread(controller, {scenario.model(), scenario.mode, scenario.reward.kind},
                      overrides);
    if (privileged) env::ReadTruth(&controller, scenario.mode);
    WorkerPool pool(std::min(workers, episodes));
    env::EvaluationOptions options;
    options.episodes = episodes;
    options.seed = seed;
    summary = task::Summarise(env::Evaluate(env::EnvFactory(scenario), controller, options, &pool));
  }
  py::dict all;
  for (std::size_t k = 0; k < summary.names.size(); ++k) {
    all[py::str(summary.names[k])] = summary.mean[k];
    all[py::str(summary.names[k] + "_std")] = summary.std[k];
  }
  return all;
}

}  // namespace

void BindPolicy(py::module_& module) {
  py::class_<Policy>(module, "Policy",
                     "A deterministic policy that agents use:\n"
                     "x = clip((observation - input_mean) / input_std, +-input_clip), then\n"
                     "x = activation(W x + b) for every hidden layer, then\n"
                     "action = action_scale tanh(W x + b).")
      .def(py::init(&MakePolicy), py::arg("layers"), py::kw_only(), py::arg("input_mean"),
           py::arg("input_std"), py::arg("observation_layout"), py::arg("action_interface"),
           py::arg("activation") = "tanh", py::arg("input_clip") = 10.0F,
           py::arg("log_std") = py::none(), py::arg("action_scale") = 1.0, py::arg("id") = "policy",
           py::arg("scenario_hash") = "", py::arg("training_step") = 0, py::arg("seed") = 0,
           py::arg("metrics") = std::map<std::string, std::string>())
      .def_static("load", &Policy::LoadOnnx, py::arg("path"), py::call_guard<WithoutGil>(),
                  "Reads an ONNX file; raises UserError for anything but a policy.")
      .def("save", &Policy::SaveOnnx, py::arg("path"),
           "Writes an ONNX file; if writing fails, an existing file is left unchanged.")
      .def("mean", &Mean, py::arg("observations"),
           "Mean actions [..., action_size] of observations [..., observation_size].")
      .def(
          "require_fits",
          [](const Policy& policy, const Scenario& scenario) {
            policy.RequireFits(scenario.model());
          },
          py::arg("scenario"),
          "Raises UserError unless layout, action interface and sizes are the scenario's.")
      .def_property_readonly("metadata", &Metadata)
      .def_property_readonly("parameters", &Parameters)
      .def_property_readonly("observation_size", &Policy::observation_size)
      .def_property_readonly("action_size", &Policy::action_size);
  module.def("evaluate", &Evaluate, py::arg("policy"), py::arg("scenario"),
             py::arg("episodes") = 30, py::arg("seed") = 3000, py::arg("workers") = 1,
             py::arg("privileged") = false, py::arg("overrides") = std::vector<std::string>(),
             "The paper's metrics of a policy file or controller. Raises UserError for `overrides` "
             "of the scenario that no flight of it reads.");
  module.def(
      "controllers", [] { return agent::Controllers().Names(); },
      "Names of the built-in controllers.");
}

}  // namespace stg::python

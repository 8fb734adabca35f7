#include "bound_env.hpp"

#include <pybind11/stl.h>
#include <unistd.h>

#include <algorithm>

#include "arrays.hpp"
#include "auv_common/error.hpp"
#include "without_gil.hpp"

namespace stg::python {

BoundEnv::Use::Use(const BoundEnv* env) : env_(*env) {
  env_.pool();
  if (env_.process_ != static_cast<int>(getpid())) {
    throw std::runtime_error(
        "this environment belongs to the process that made it: threads do not survive a fork; make "
        "an environment in each process");
  }
  if (env_.busy_.test_and_set(std::memory_order_acquire)) {
    throw std::runtime_error("another thread is using this environment");
  }
}

namespace {

const std::vector<Scenario>& RequireThatAllAreUsed(const std::vector<Scenario>& mix, int envs) {
  if (envs > 0 && static_cast<int>(mix.size()) > env::MostOfMix(envs)) {
    throw UserError(std::to_string(mix.size()) + " scenarios need more environments, because " +
                    std::to_string(env::kMixBlock) + " have the same one");
  }
  return mix;
}

}  // namespace

BoundEnv::BoundEnv(const std::vector<Scenario>& mix, const env::VectorEnvOptions& options,
                   int workers)
    : pool_(std::make_unique<EnvPool>(RequireThatAllAreUsed(mix, options.envs), options, workers)),
      envs_(options.envs),
      process_(static_cast<int>(getpid())) {
  const env::VectorEnv& first = *pool_->parts().front().envs;
  agents_ = first.agents();
  action_size_ = first.action_size();
  observation_size_ = first.observation_size();
  state_size_ = first.state_size();
  for (int i = 0; i < agents_; ++i) names_.emplace_back("auv_" + std::to_string(i));
  actions_.resize(static_cast<std::size_t>(agents_) * static_cast<std::size_t>(action_size_));
}

BoundEnv::~BoundEnv() {
  // In a forked process the threads do not exist, so they cannot be joined.
  if (process_ != static_cast<int>(getpid())) (void)pool_.release();
}

const EnvPool& BoundEnv::pool() const {
  if (pool_ == nullptr) throw std::runtime_error("the environment is closed");
  return *pool_;
}

void BoundEnv::RequireEnv(int env) const {
  if (env < 0 || env >= envs_) {
    throw py::index_error("environment " + std::to_string(env) + " of " + std::to_string(envs_));
  }
}

EnvPool::Place BoundEnv::at(int env) const {
  RequireEnv(env);
  return pool().at(env);
}

void BoundEnv::RequireBound() const {
  if (out_.observations == nullptr) throw std::runtime_error("no arrays are bound");
}

void BoundEnv::Bind(const py::dict& arrays) {
  const Use use(this);
  env::EnvArrays out;
  const Shape rows{envs_, agents_, observation_size_}, states{envs_, state_size_};
  for (const auto& [key, array] : arrays) {
    const std::string name = py::str(key).cast<std::string>();
    if (array.is_none()) continue;
    if (name == "observations") {
      out.observations = RequireOutput<float>(array, name, rows);
    } else if (name == "states") {
      out.states = RequireOutput<float>(array, name, states);
    } else if (name == "rewards") {
      out.rewards = RequireOutput<float>(array, name, {envs_, agents_});
    } else if (name == "team_rewards") {
      out.team_rewards = RequireOutput<float>(array, name, {envs_});
    } else if (name == "truncated") {
      out.truncated = reinterpret_cast<std::uint8_t*>(RequireOutput<bool>(array, name, {envs_}));
    } else if (name == "final_observations") {
      out.final_observations = RequireOutput<float>(array, name, rows);
    } else if (name == "final_states") {
      out.final_states = RequireOutput<float>(array, name, states);
    } else {
      throw py::value_error("no array is called '" + name + "'");
    }
  }
  if (out.observations == nullptr || out.truncated == nullptr) {
    throw py::value_error("the arrays observations and truncated are needed");
  }
  arrays_ = py::dict(**arrays);
  out_ = out;
}

void BoundEnv::RestartAt(std::uint64_t k) {
  const Use use(this);
  RequireBound();
  const WithoutGil release;
  pool_->RestartAt(k, out_);
}

void BoundEnv::Reseed(std::uint64_t seed) {
  const Use use(this);
  pool_->Reseed(seed);
}

void BoundEnv::ResetEnv(int env, std::uint64_t seed) {
  RequireEnv(env);
  const Use use(this);
  RequireBound();
  const WithoutGil release;
  pool_->ResetEnv(env, seed, out_);
}

template <class Number>
int BoundEnv::StepChecked(const Number* actions) {
  const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(agents_) * action_size_;
  const std::ptrdiff_t bad = FindNotFinite(actions, envs_ * row);
  if (bad >= 0) {
    throw py::value_error("actions[" + std::to_string(bad / row) + ", " +
                          std::to_string(bad % row / action_size_) + ", " +
                          std::to_string(bad % action_size_) + "] is not finite");
  }
  const WithoutGil release;
  pool_->Step(actions, out_);
  return static_cast<int>(std::count(out_.truncated, out_.truncated + envs_, 1));
}

int BoundEnv::Step(const py::handle& actions) {
  const Use use(this);
  RequireBound();
  const Floats floats = RequireFloats(actions, "actions", {envs_, agents_, action_size_});
  return floats.wide ? StepChecked(static_cast<const double*>(floats.array.data()))
                     : StepChecked(static_cast<const float*>(floats.array.data()));
}

int BoundEnv::StepAgents(const py::dict& actions) {
  const Use use(this);
  RequireBound();
  if (envs_ != 1) throw std::runtime_error("actions by name are for one environment");
  const Shape shape{action_size_};
  float* to = actions_.data();
  for (const py::str& name : names_) {
    PyObject* action = PyDict_GetItemWithError(actions.ptr(), name.ptr());
    if (action == nullptr) {
      if (PyErr_Occurred() != nullptr) throw py::error_already_set();
      throw py::value_error("no action for " + name.cast<std::string>());
    }
    const std::string what = "action of " + name.cast<std::string>();
    const Floats floats = RequireFloats(action, what, shape);
    for (int k = 0; k < action_size_; ++k, ++to) {
      *to = floats.wide ? static_cast<float>(static_cast<const double*>(floats.array.data())[k])
                        : static_cast<const float*>(floats.array.data())[k];
      if (FindNotFinite(to, 1) == 0) {
        throw py::value_error(what + ": component " + std::to_string(k) + " is not finite");
      }
    }
  }
  if (static_cast<int>(actions.size()) != agents_) {
    throw py::value_error("actions for " + std::to_string(actions.size()) + " AUVs, there are " +
                          std::to_string(agents_) + ": auv_0 to auv_" +
                          std::to_string(agents_ - 1));
  }
  return StepChecked(actions_.data());
}

const agent::Decider& BoundEnv::ControllerOf(const std::string& name, bool privileged) {
  const EnvPool& pool = *pool_;
  const Scenario& scenario = pool.parts().front().envs->scenario();
  if (controller_.name != name) controller_ = agent::MakeDecider(name, scenario.model());
  controller_.privileged = false;
  if (privileged) env::ReadTruth(&controller_, scenario.mode);
  return controller_;
}

py::array_t<float> BoundEnv::Decide(const std::string& name, bool privileged) {
  const Use use(this);
  RequireBound();
  const agent::Decider& controller = ControllerOf(name, privileged);
  py::array_t<float> actions(Shape{envs_, agents_, action_size_});
  float* to = actions.mutable_data();
  const WithoutGil release;
  for (const EnvPool::Part& part : pool_->parts()) {
    const env::VectorEnv& envs = *part.envs;
    std::vector<double> wanted(static_cast<std::size_t>(envs.envs() * agents_ * action_size_));
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(agents_) * observation_size_;
    env::Decide(controller, envs, out_.observations + part.first * row, wanted.data());
    to = std::transform(wanted.begin(), wanted.end(), to,
                        [](double x) { return static_cast<float>(x); });
  }
  return actions;
}

void BoundEnv::Close() {
  if (pool_ == nullptr) return;
  const Use use(this);
  pool_.reset();
  arrays_ = py::dict();
  out_ = {};
}

Scenario BoundEnv::scenario(int env) const {
  const Use use(this);
  const EnvPool::Place place = at(env);
  return place.envs.scenario(place.env);
}

std::uint64_t BoundEnv::seed(int env) const {
  const Use use(this);
  const EnvPool::Place place = at(env);
  return place.envs.seed(place.env);
}

std::uint64_t BoundEnv::round(int env) const {
  const Use use(this);
  const EnvPool::Place place = at(env);
  return place.envs.round(place.env);
}

int BoundEnv::step(int env) const {
  const Use use(this);
  const EnvPool::Place place = at(env);
  return place.envs.step(place.env);
}

py::dict BoundEnv::Metrics(int env) const {
  const Use use(this);
  const EnvPool::Place place = at(env);
  py::dict metrics;
  for (const auto& [name, value] : place.envs.metrics(place.env).Items()) {
    metrics[py::str(name)] = value;
  }
  return metrics;
}

}  // namespace stg::python

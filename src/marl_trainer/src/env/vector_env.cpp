#include "marl_trainer/env/vector_env.hpp"

#include <algorithm>

#include "auv_common/error.hpp"
#include "marl_trainer/env/env.hpp"

namespace stg::env {
namespace {

std::size_t Size(int a, int b = 1, int c = 1) {
  return static_cast<std::size_t>(a) * static_cast<std::size_t>(b) * static_cast<std::size_t>(c);
}

/// Copies `rows` rows of `width` numbers to the rows from `first` on; to null: nothing.
void CopyRows(const float* from, int rows, int width, int first, float* to) {
  if (to != nullptr) std::copy_n(from, Size(rows, width), to + Size(first, width));
}

void RequireOneLayout(const std::vector<Scenario>& mix) {
  if (mix.empty()) throw UserError("an environment needs a scenario");
  const Scenario& a = mix.front();
  for (const Scenario& b : mix) {
    if (b.agents != a.agents || b.target.count != a.target.count ||
        b.action_size() != a.action_size() || b.observation_size() != a.observation_size()) {
      throw UserError("scenarios of a mix must agree in agents, targets, actions and observation");
    }
  }
}

}  // namespace

VectorEnv::VectorEnv(const Scenario& scenario, const VectorEnvOptions& options)
    : VectorEnv(std::vector<Scenario>{scenario}, options) {}

VectorEnv::VectorEnv(const std::vector<Scenario>& mix, const VectorEnvOptions& options)
    : mix_(mix), options_(options) {
  RequireOneLayout(mix_);
  if (options_.total_envs == 0) options_.total_envs = options_.envs;
  if (options_.envs < 1 || options_.first_env < 0 || options_.total_envs < options_.envs) {
    throw UserError("environments must be at least one, and no more than all together");
  }
  EnvOptions o;
  o.seed = options_.seed;
  o.total_envs = options_.total_envs;
  slice_of_.resize(Size(options_.envs));
  for (int env = 0; env < options_.envs;) {
    int count = 1;
    const Scenario* s = &scenario(env);
    // Lanes share a scenario and the length of a first episode.
    while (count < kLanes && env + count < options_.envs && &scenario(env + count) == s &&
           stagger(env + count) == stagger(env)) {
      ++count;
    }
    o.first_env = options_.first_env + env;
    o.curriculum = options_.curriculum && s->reset.curriculum;
    groups_.emplace_back(*s, o);
    slices_.push_back({nullptr, env, count});
    std::fill_n(slice_of_.begin() + env, count, static_cast<int>(slices_.size()) - 1);
    env += count;
  }
  for (std::size_t g = 0; g < slices_.size(); ++g) slices_[g].group = &groups_[g];
  actions_.assign(Size(kLanes, agents(), action_size()), 0.0);
}

VectorEnv::~VectorEnv() = default;
VectorEnv::VectorEnv(VectorEnv&&) noexcept = default;

int VectorEnv::state_size() const { return groups_.front().state_size(); }

const Scenario& VectorEnv::scenario(int env) const {
  const auto block = Size(options_.first_env + env) / kMixBlock;
  return mix_[block % mix_.size()];
}

int VectorEnv::stagger(int env) const {
  if (!options_.stagger) return 0;
  const int blocks = (options_.total_envs + kMixBlock - 1) / kMixBlock;
  const int block = (options_.first_env + env) / kMixBlock;
  return std::max(1, scenario(env).time.episode_steps * (block + 1) / blocks);
}

const VectorEnv::Slice& VectorEnv::SliceOf(int env) const {
  return slices_[static_cast<std::size_t>(slice_of_[static_cast<std::size_t>(env)])];
}

int VectorEnv::step(int env) const { return SliceOf(env).group->step(); }
std::uint64_t VectorEnv::round(int env) const { return SliceOf(env).group->round(); }

std::uint64_t VectorEnv::seed(int env) const {
  const Slice& slice = SliceOf(env);
  return slice.group->world().seed(env - slice.first);
}

const task::EpisodeMetrics& VectorEnv::metrics(int env) const {
  const Slice& slice = SliceOf(env);
  return slice.group->metrics(env - slice.first);
}

void VectorEnv::RestartAt(std::uint64_t k, const EnvArrays& out) {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    groups_[g].RestartAt(k, stagger(slices_[g].first));
    WriteStart(slices_[g], out);
  }
}

void VectorEnv::WriteStart(const Slice& slice, const EnvArrays& out) const {
  const EnvGroup& group = *slice.group;
  CopyRows(group.observations(), slice.count, agents() * observation_size(), slice.first,
           out.observations);
  CopyRows(group.states(), slice.count, state_size(), slice.first, out.states);
}

void VectorEnv::Step(const float* actions, const EnvArrays& out) { StepAll(actions, out); }
void VectorEnv::Step(const double* actions, const EnvArrays& out) { StepAll(actions, out); }

template <class Number>
void VectorEnv::StepAll(const Number* actions, const EnvArrays& out) {
  const int per_env = agents() * action_size();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Slice& slice = slices_[g];
    EnvGroup& group = groups_[g];
    const Number* own = actions + Size(slice.first, per_env);
    std::copy_n(own, Size(slice.count, per_env), actions_.begin());
    std::fill(actions_.begin() + static_cast<std::ptrdiff_t>(Size(slice.count, per_env)),
              actions_.end(), 0.0);
    group.Step(actions_.data());
    WriteStart(slice, out);
    CopyRows(group.rewards(), slice.count, 1, slice.first, out.team_rewards);
    for (int lane = 0; lane < slice.count; ++lane) {
      const auto env = Size(slice.first + lane);
      for (int i = 0; i < agents() && out.rewards != nullptr; ++i) {
        out.rewards[env * Size(agents()) + Size(i)] =
            static_cast<float>(Lane(group.terms(i).total, lane));
      }
      if (out.truncated != nullptr) out.truncated[env] = group.truncated() ? 1 : 0;
    }
    if (!group.truncated()) continue;
    CopyRows(group.final_observations(), slice.count, agents() * observation_size(), slice.first,
             out.final_observations);
    CopyRows(group.final_states(), slice.count, state_size(), slice.first, out.final_states);
  }
}

}  // namespace stg::env

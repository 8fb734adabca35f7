#include "stg_env/env/vector_env.hpp"

#include <algorithm>
#include <stdexcept>

#include "auv_common/error.hpp"
#include "environment.hpp"
#include "scatter.hpp"

namespace stg::env {
namespace {

constexpr std::size_t kBlock = 4;  ///< number of slices whose half steps run together

std::size_t Size(int a, int b = 1, int c = 1) {
  return static_cast<std::size_t>(a) * static_cast<std::size_t>(b) * static_cast<std::size_t>(c);
}

void RequireOneLayout(const std::vector<Scenario>& mix) {
  if (mix.empty()) throw UserError("an environment needs a scenario");
  const Scenario& a = mix.front();
  for (const Scenario& b : mix) {
    if (b.run.agents != a.run.agents || b.world.target.count != a.world.target.count ||
        b.world.control.action_size() != a.world.control.action_size() ||
        b.agent.observation_size() != a.agent.observation_size() ||
        b.world.sea.open != a.world.sea.open) {
      throw UserError(
          "scenarios of a mix must agree in agents, targets, actions, observation and sea.open");
    }
  }
}

}  // namespace

VectorEnv::VectorEnv(const Scenario& scenario, const VectorEnvOptions& options)
    : VectorEnv(std::vector<Scenario>{scenario}, options) {}

VectorEnv::VectorEnv(const std::vector<Scenario>& mix, const VectorEnvOptions& options)
    : mix_(mix), options_(options) {
  RequireOneLayout(mix_);
  observation_size_ = mix_.front().agent.observation_size();
  state_size_ = task::CriticStateSize(mix_.front().run, mix_.front().world);
  if (options_.total_envs == 0) options_.total_envs = options_.envs;
  if (options_.envs < 1 || options_.first_env < 0 || options_.total_envs < options_.envs) {
    throw UserError(
        "an environment object needs at least one environment, and total_envs must not be smaller "
        "than envs");
  }
  slice_of_.resize(Size(options_.envs));
  for (int env = 0; env < options_.envs;) {
    int count = 1;
    // The lanes of a slice have the same scenario.
    while (count < kLanes && env + count < options_.envs &&
           &scenario(env + count) == &scenario(env)) {
      ++count;
    }
    std::fill_n(slice_of_.begin() + env, count, static_cast<int>(slices_.size()));
    slices_.push_back({std::make_unique<Environment>(scenario(env)), env, count});
    env += count;
  }
  round_.assign(slice_of_.size(), 0);
  finished_.resize(slice_of_.size());
  wanted_.assign(slices_.size() * Size(agents(), action_size()), Pack(0.0));
  rows_.resize(Size(kLanes, std::max(agents() * observation_size(), state_size())));
}

VectorEnv::~VectorEnv() = default;
VectorEnv::VectorEnv(VectorEnv&&) noexcept = default;

const Scenario& VectorEnv::scenario(int env) const {
  const auto block = Size(options_.first_env + env) / kMixBlock;
  return mix_[block % mix_.size()];
}

const VectorEnv::Slice& VectorEnv::SliceOf(int env) const {
  return slices_[static_cast<std::size_t>(slice_of_[static_cast<std::size_t>(env)])];
}

int VectorEnv::FirstLength(int env) const {
  const int whole = scenario(env).run.time.episode_steps;
  if (!options_.stagger) return whole;
  const int blocks = (options_.total_envs + kMixBlock - 1) / kMixBlock;
  const int block = (options_.first_env + env) / kMixBlock;
  return std::max(1, whole * (block + 1) / blocks);
}

void VectorEnv::Restart(const Slice& slice, int lane, bool first) {
  // Lanes beyond the last environment copy the first lane.
  const int env = slice.first + (lane < slice.count ? lane : 0);
  const Scenario& s = scenario(env);
  const std::uint64_t r =
      static_cast<std::uint64_t>(options_.first_env + env) +
      round_[static_cast<std::size_t>(env)] * static_cast<std::uint64_t>(options_.total_envs);
  dynamics::ResetStage stage = s.world.reset.stage;
  if (options_.curriculum && s.world.reset.curriculum) {
    stage = r < static_cast<std::uint64_t>(s.world.reset.curriculum_easy_resets)
                ? dynamics::ResetStage::kEasy
            : r < static_cast<std::uint64_t>(s.world.reset.curriculum_medium_resets)
                ? dynamics::ResetStage::kMedium
                : dynamics::ResetStage::kHard;
  }
  slice.lanes->Reset(lane, options_.seed + r, stage,
                     first ? FirstLength(env) : s.run.time.episode_steps);
}

void VectorEnv::RestartAt(std::uint64_t k, const EnvArrays& out) {
  std::fill(round_.begin(), round_.end(), k);
  for (const Slice& slice : slices_) {
    for (int lane = 0; lane < kLanes; ++lane) Restart(slice, lane, true);
    slice.lanes->Begin(LaneSet::All());
    WriteStart(slice, out);
  }
}

void VectorEnv::ResetEnv(int env, std::uint64_t seed, const EnvArrays& out) {
  const Slice& slice = SliceOf(env);
  const Scenario& s = scenario(env);
  LaneSet lanes;
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool follows = env == slice.first && lane >= slice.count;
    if (lane != env - slice.first && !follows) continue;
    slice.lanes->Reset(lane, seed, s.world.reset.stage, s.run.time.episode_steps);
    lanes.in[static_cast<std::size_t>(lane)] = true;
  }
  slice.lanes->Begin(lanes);
  WriteStart(slice, out);
}

void VectorEnv::Place(const std::vector<Vec3<double>>& p_WB, const std::vector<Vec3<double>>& p_WT,
                      const std::vector<Vec3<double>>& v_WT, const EnvArrays& out) {
  std::fill(round_.begin(), round_.end(), 0);
  for (const Slice& slice : slices_) {
    for (int lane = 0; lane < kLanes; ++lane) slice.lanes->Place(lane, p_WB, p_WT, v_WT);
    slice.lanes->Begin(LaneSet::All());
    WriteStart(slice, out);
  }
}

void VectorEnv::Step(const float* actions, const EnvArrays& out) { StepAll(actions, out); }
void VectorEnv::Step(const double* actions, const EnvArrays& out) { StepAll(actions, out); }

template <class Number>
void VectorEnv::TakeActions(const Number* actions) {
  const int size = agents() * action_size();
  Pack finite(0.0);
  Pack* wanted = wanted_.data();
  for (const Slice& slice : slices_) {
    Gather(actions + Size(slice.first, size), Size(size), slice.count, size, wanted);
    for (int k = 0; k < size; ++k) finite += wanted[k] - wanted[k];
    wanted += size;
  }
  if (Any(!(finite == Pack(0.0)))) throw std::invalid_argument("non-finite action");
}

template <class Number>
void VectorEnv::StepAll(const Number* actions, const EnvArrays& out) {
  TakeActions(actions);
  // The code of a whole step does not fit into the instruction cache, but the code of half a step
  // does. So each half runs over some environments before the other half runs.
  for (std::size_t first = 0; first < slices_.size(); first += kBlock) {
    const std::size_t last = std::min(first + kBlock, slices_.size());
    for (std::size_t k = first; k < last; ++k) {
      slices_[k].lanes->Move(wanted_.data() + k * Size(agents(), action_size()));
    }
    for (std::size_t k = first; k < last; ++k) Judge(slices_[k], out);
  }
}

void VectorEnv::Judge(const Slice& slice, const EnvArrays& out) {
  Environment& lanes = *slice.lanes;
  lanes.Judge();
  if (out.rewards != nullptr) {
    lanes.WriteRewards(slice.count, out.rewards + Size(slice.first, agents()));
  }
  LaneSet done;
  for (int lane = 0; lane < kLanes; ++lane) {
    done.in[static_cast<std::size_t>(lane)] = lanes.Done(lane);
    if (lane >= slice.count) continue;
    const std::size_t env = Size(slice.first + lane);
    if (out.team_rewards != nullptr) {
      out.team_rewards[env] = static_cast<float>(Lane(lanes.task().team_reward(), lane));
    }
    if (out.truncated != nullptr) out.truncated[env] = done[lane] ? 1 : 0;
  }
  if (done.any()) Finish(slice, done, out);
  WriteStart(slice, out);
}

void VectorEnv::Finish(const Slice& slice, const LaneSet& done, const EnvArrays& out) {
  Environment& lanes = *slice.lanes;
  // Only the rows of ended episodes are written. The final rows of the others stay unchanged.
  const auto copy = [&](float* to, int width) {
    for (int lane = 0; lane < slice.count && to != nullptr; ++lane) {
      if (!done[lane]) continue;
      std::copy_n(rows_.begin() + lane * width, width, to + Size(slice.first + lane, width));
    }
  };
  lanes.WriteObservations(slice.count, rows_.data());
  copy(out.final_observations, agents() * observation_size());
  lanes.WriteStates(slice.count, rows_.data());
  copy(out.final_states, state_size());
  for (int lane = 0; lane < kLanes; ++lane) {
    if (!done[lane]) continue;
    if (lane < slice.count) {
      const std::size_t env = Size(slice.first + lane);
      finished_[env] = lanes.task().Metrics(lane);
      ++round_[env];
    }
    Restart(slice, lane, false);
  }
  lanes.Begin(done);
}

void VectorEnv::WriteStart(const Slice& slice, const EnvArrays& out) const {
  if (out.observations != nullptr) {
    slice.lanes->WriteObservations(
        slice.count, out.observations + Size(slice.first, agents(), observation_size()));
  }
  if (out.states != nullptr) {
    slice.lanes->WriteStates(slice.count, out.states + Size(slice.first, state_size()));
  }
}

}  // namespace stg::env

#include "marl_trainer/learn/buffers/replay_buffer.hpp"

#include <algorithm>
#include <cassert>
#include <string>

#include "auv_common/error.hpp"

namespace stg::learn {
namespace {

std::size_t Index(std::int64_t i) { return static_cast<std::size_t>(i); }

void Append(const float* from, int count, std::vector<float>* to) {
  to->insert(to->end(), from, from + count);
}

}  // namespace

ReplayBuffer::ReplayBuffer(const Problem& problem, std::int64_t capacity, int n_step, double gamma,
                           bool own_rewards)
    : agents_(problem.agents),
      observation_row_(problem.agents * problem.observation_size),
      state_row_(problem.state_size),
      action_row_(problem.agents * problem.action_size),
      capacity_(capacity),
      n_step_(n_step),
      own_row_(own_rewards ? problem.agents : 0) {
  assert(n_step >= 1);
  double power = 1.0;
  for (int k = 0; k <= n_step; ++k, power *= gamma) powers_.push_back(static_cast<float>(power));
}

void ReplayBuffer::Resize(Block* block, int steps, int envs) const {
  const std::int64_t samples = static_cast<std::int64_t>(steps) * envs;
  block->steps = steps;
  block->envs = envs;
  block->observations.resize(Index(samples * observation_row_));
  block->states.resize(Index(samples * state_row_));
  block->actions.resize(Index(samples * action_row_));
  block->rewards.resize(Index(samples));
  block->own_rewards.resize(Index(samples * own_row_));
  block->end.assign(Index(samples), -1);
  block->end_observations.clear();
  block->end_states.clear();
}

void ReplayBuffer::Begin(const Collection& collection) {
  std::vector<std::int64_t> first(1, 0);
  for (const Shard& shard : collection.shards) {
    first.push_back(first.back() + static_cast<std::int64_t>(collection.steps) * shard.envs);
  }
  if (!first_.empty() && first != first_) {
    throw UserError("the replayed transitions are of environments in other shards");
  }
  first_ = std::move(first);
  const std::size_t chunks = Index(std::max<std::int64_t>(1, capacity_ / first_.back()));
  if (chunks_.size() < chunks) {
    newest_ = chunks_.size();
    chunks_.emplace_back(collection.shards.size());
  } else {
    newest_ = (newest_ + 1) % chunks_.size();
  }
  Chunk& chunk = chunks_[newest_];
  for (std::size_t s = 0; s < chunk.size(); ++s) {
    Resize(&chunk[s], collection.steps, collection.shards[s].envs);
  }
}

void ReplayBuffer::Add(const Transition& t) {
  Block& b = chunks_[newest_][Index(t.shard)];
  assert(t.envs == b.envs && t.step < b.steps);
  const std::int64_t first = static_cast<std::int64_t>(t.step) * t.envs;
  std::copy_n(t.observations, t.envs * observation_row_,
              b.observations.data() + first * observation_row_);
  std::copy_n(t.states, t.envs * state_row_, b.states.data() + first * state_row_);
  std::copy_n(t.actions, t.envs * action_row_, b.actions.data() + first * action_row_);
  std::copy_n(t.team_rewards, t.envs, b.rewards.data() + first);
  std::copy_n(t.rewards, t.envs * own_row_, b.own_rewards.data() + first * own_row_);
  for (int e = 0; e < t.envs; ++e) {
    const bool truncated = t.truncated[e] != 0;
    if (!truncated && t.step + 1 < b.steps) continue;
    b.end[Index(first + e)] = static_cast<std::int64_t>(b.end_states.size()) / state_row_;
    Append((truncated ? t.final_observations : t.next_observations) + e * observation_row_,
           observation_row_, &b.end_observations);
    Append((truncated ? t.final_states : t.next_states) + e * state_row_, state_row_,
           &b.end_states);
  }
}

std::int64_t ReplayBuffer::size() const {
  return first_.empty() ? 0 : static_cast<std::int64_t>(chunks_.size()) * first_.back();
}

ReplayBuffer::Place ReplayBuffer::Draw(Random* random) const {
  const auto all = static_cast<std::int64_t>(random->Uniform() * static_cast<double>(size()));
  const std::int64_t in_chunk = all % first_.back();
  const auto shard = std::upper_bound(first_.begin(), first_.end(), in_chunk) - first_.begin() - 1;
  return {Index(all / first_.back()), Index(shard), Index(in_chunk - first_[Index(shard)])};
}

ReplayBuffer::Sample ReplayBuffer::At(const Place& place) const {
  const Block& b = chunks_[place.chunk][place.shard];
  auto at = static_cast<std::int64_t>(place.sample);
  Sample s;
  s.observations = b.observations.data() + at * observation_row_;
  s.state = b.states.data() + at * state_row_;
  s.actions = b.actions.data() + at * action_row_;
  for (int k = 0;; ++k, at += b.envs) {
    const float power = powers_[Index(k)];
    s.reward += power * b.rewards[Index(at)];
    s.weight += power;
    s.discount = powers_[Index(k + 1)];
    const std::int64_t end = b.end[Index(at)];
    if (end >= 0) {
      s.next_observations = b.end_observations.data() + end * observation_row_;
      s.next_state = b.end_states.data() + end * state_row_;
      return s;
    }
    if (k + 1 == n_step_) break;
  }
  at += b.envs;
  s.next_observations = b.observations.data() + at * observation_row_;
  s.next_state = b.states.data() + at * state_row_;
  return s;
}

void ReplayBuffer::OwnRewards(const Place& place, float* rewards) const {
  const Block& b = chunks_[place.chunk][place.shard];
  auto at = static_cast<std::int64_t>(place.sample);
  std::fill_n(rewards, own_row_, 0.0F);
  for (int k = 0; k < n_step_; ++k, at += b.envs) {
    const float* own = b.own_rewards.data() + at * own_row_;
    for (int i = 0; i < own_row_; ++i) rewards[i] += powers_[Index(k)] * own[i];
    if (b.end[Index(at)] >= 0) return;
  }
}

void ReplayBuffer::Save(Archive* archive) const {
  std::vector<std::int64_t> shape{static_cast<std::int64_t>(chunks_.size()),
                                  static_cast<std::int64_t>(newest_)};
  if (!chunks_.empty()) {
    for (const Block& b : chunks_.front()) {
      shape.push_back(b.steps);
      shape.push_back(b.envs);
    }
  }
  archive->Put("replay_shape", shape);
  for (std::size_t c = 0; c < chunks_.size(); ++c) {
    for (std::size_t s = 0; s < chunks_[c].size(); ++s) {
      const Block& b = chunks_[c][s];
      const std::string name = "replay_" + std::to_string(c) + "_" + std::to_string(s) + "_";
      archive->Put(name + "observations", b.observations);
      archive->Put(name + "states", b.states);
      archive->Put(name + "actions", b.actions);
      archive->Put(name + "rewards", b.rewards);
      if (own_row_ > 0) archive->Put(name + "own_rewards", b.own_rewards);
      archive->Put(name + "end", b.end);
      archive->Put(name + "end_observations", b.end_observations);
      archive->Put(name + "end_states", b.end_states);
    }
  }
}

void ReplayBuffer::Load(const Archive& archive) {
  const std::vector<std::int64_t>& shape = archive.Integers("replay_shape");
  const auto refuse = [](bool bad) {
    if (bad) throw UserError("the replayed transitions have another shape");
  };
  refuse(shape.size() < 2 || shape.size() % 2 != 0 || shape[0] < 0 || shape[1] < 0);
  const std::size_t count = Index(shape[0]), shards = shape.size() / 2 - 1;
  refuse(count > 0 && (shards == 0 || Index(shape[1]) >= count));
  std::vector<Chunk> chunks(count, Chunk(shards));
  std::vector<std::int64_t> first(1, 0);
  for (std::size_t s = 0; s < shards; ++s) {
    const std::int64_t steps = shape[2 + 2 * s], envs = shape[3 + 2 * s];
    refuse(steps < 1 || steps > 100000 || envs < 1 || envs > 65536);
    first.push_back(first.back() + steps * envs);
    for (std::size_t c = 0; c < count; ++c) {
      Block& b = chunks[c][s];
      const std::string name = "replay_" + std::to_string(c) + "_" + std::to_string(s) + "_";
      const std::size_t samples = Index(steps * envs);
      b.steps = static_cast<int>(steps);
      b.envs = static_cast<int>(envs);
      b.observations = archive.Floats(name + "observations", samples * Index(observation_row_));
      b.states = archive.Floats(name + "states", samples * Index(state_row_));
      b.actions = archive.Floats(name + "actions", samples * Index(action_row_));
      b.rewards = archive.Floats(name + "rewards", samples);
      if (own_row_ > 0) {
        b.own_rewards = archive.Floats(name + "own_rewards", samples * Index(own_row_));
      }
      b.end = archive.Integers(name + "end");
      b.end_states = archive.Floats(name + "end_states");
      const std::size_t ends = b.end_states.size() / Index(state_row_);
      b.end_observations =
          archive.Floats(name + "end_observations", ends * Index(observation_row_));
      refuse(b.end.size() != samples || b.end_states.size() != ends * Index(state_row_));
      for (std::size_t i = 0; i < samples; ++i) {
        const bool last = i + Index(envs) >= samples;
        refuse(b.end[i] >= static_cast<std::int64_t>(ends) || (last && b.end[i] < 0));
      }
    }
  }
  chunks_ = std::move(chunks);
  newest_ = Index(shape[1]);
  first_ = std::move(first);
  if (chunks_.empty()) first_.clear();
}

}  // namespace stg::learn

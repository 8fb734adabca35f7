#include "marl_trainer/learn/algorithms/off_policy/replay_learner.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/nn/moments_of_ranks.hpp"

namespace stg::learn {
namespace {

constexpr int kMomentStride = 4;  // the normalisers use every n-th decision
/// Number of rewards that the scale of the values remembers [environment steps].
constexpr double kRewardMemory = 30000.0;
/// Limits the scale if rewards hardly differ.
constexpr double kSmallestRewardStd = 0.01;

}  // namespace

ReplayLearner::ReplayLearner(const ReplayOptions& options, const TrainConfig& common,
                             const Problem& problem, const Team& team, bool own_rewards)
    : options_(options),
      problem_(problem),
      seed_(common.seed),
      own_rewards_(own_rewards),
      team_(team),
      slices_(team.share()),
      replay_(problem, options.replay, options.n_step, options.gamma, own_rewards),
      observations_(problem.observation_size),
      states_(problem.state_size),
      rewards_(1) {
  for (int s = 0; s < kGroups; ++s) {
    batches_.emplace_back(problem, slice_rows(), own_rewards);
  }
  UpdateScales();
}

int ReplayLearner::slice_rows() const { return (options_.batch + kGroups - 1) / kGroups; }

double ReplayLearner::Rank(int env) const {
  return envs_ > 1 ? static_cast<double>(env) / (envs_ - 1) : 0.5;
}

void ReplayLearner::Begin(const Collection& collection) {
  Collection all = collection;
  all.shards = team_.ranks->Gather(collection.shards);
  const auto counts = team_.ranks->Gather(std::vector<std::size_t>{collection.shards.size()});
  first_shard_ =
      std::accumulate(counts.begin(), counts.begin() + team_.ranks->rank(), std::size_t{0});
  replay_.Begin(all);
  collected_.assign(collection.shards.size(),
                    {RunningMoments(problem_.observation_size), RunningMoments(problem_.state_size),
                     RunningMoments(1)});
  envs_ = 0;
  for (const Shard& shard : all.shards) envs_ += shard.envs;
  collected_steps_ = static_cast<std::int64_t>(envs_) * collection.steps;
}

void ReplayLearner::Observe(const Transition& t) {
  Moments& m = collected_[static_cast<std::size_t>(t.shard)];
  if (t.step % kMomentStride == 0) {
    m.observations.Add(t.observations, t.envs * problem_.agents);
    m.states.Add(t.states, t.envs);
  }
  if (own_rewards_) {
    m.rewards.Add(t.rewards, t.envs * problem_.agents);
  } else {
    m.rewards.Add(t.team_rewards, t.envs);
  }
  Transition numbered = t;
  numbered.shard += static_cast<int>(first_shard_);
  replay_.Add(numbered);
}

void ReplayLearner::TakeInMoments() {
  constexpr std::size_t kKinds = 3;
  std::vector<RunningMoments> own;
  for (const Moments& m : collected_) {
    own.insert(own.end(), {m.observations, m.states, m.rewards});
  }
  const std::vector<RunningMoments> all = OfAllRanks(team_.ranks, own, kKinds);
  for (std::size_t k = 0; k < all.size(); k += kKinds) {
    observations_.Merge(all[k]);
    states_.Merge(all[k + 1]);
    rewards_.Merge(all[k + 2]);
  }
}

void ReplayLearner::UpdateScales() {
  const auto floor = static_cast<float>(options_.std_floor);
  const auto clip = static_cast<float>(options_.observation_clip);
  scales_.observations = Normaliser::From(observations_, floor, clip);
  scales_.states = Normaliser::From(states_, floor, clip);
  scales_.action = static_cast<float>(problem_.action_scale);
  if (rewards_.count() == 0.0) return;
  const double horizon = 1.0 / (1.0 - options_.gamma);
  const double mean = rewards_.mean(0);
  const double std = std::max(std::sqrt(rewards_.variance(0)), kSmallestRewardStd) * horizon;
  scales_.reward_mean = static_cast<float>(mean);
  scales_.reward_std = static_cast<float>(std);
  scales_.value_mean = static_cast<float>(mean * horizon);
}

void ReplayLearner::DrawBatch(std::uint32_t number) {
  team_.pool->Run(slices_.count, [&](int own, int) {
    const int slice = slices_.first + own;
    const int begin = options_.batch * slice / kGroups;
    const int end = options_.batch * (slice + 1) / kGroups;
    ReplayBatch& batch = batches_[static_cast<std::size_t>(slice)];
    batch.count = end - begin;
    Random random(seed_, Stream::kReplay, number, 0, static_cast<std::uint32_t>(slice));
    for (int row = 0; row < batch.count; ++row) {
      const ReplayBuffer::Place place = replay_.Draw(&random);
      const ReplayBuffer::Sample sample = replay_.At(place);
      batch.Set(row, sample, scales_);
      if (!own_rewards_) continue;
      replay_.OwnRewards(
          place, batch.own_rewards.data() + static_cast<std::ptrdiff_t>(row) * problem_.agents);
      batch.ScaleOwnRewards(row, sample, scales_);
    }
  });
}

UpdateReport ReplayLearner::Update(const UpdateContext& context) {
  const ReplayScales before = scales_;
  // Without rewards, the untrained critic has no scale yet.
  const bool scaled = rewards_.count() > 0.0;
  replay_.Exchange(team_.ranks, first_shard_, collected_.size());
  TakeInMoments();
  rewards_.LimitCount(kRewardMemory);
  UpdateScales();
  const auto old_std = static_cast<double>(before.reward_std);
  const auto new_std = static_cast<double>(scales_.reward_std);
  if (scaled) {
    RescaleValues(old_std / new_std, (static_cast<double>(before.value_mean) -
                                      static_cast<double>(scales_.value_mean)) /
                                         new_std);
  }
  const bool learns = seen_ + collected_steps_ > options_.warmup;
  seen_ += collected_steps_;
  if (learns) due_ += options_.replayed * static_cast<double>(collected_steps_) / options_.batch;
  const int steps = static_cast<int>(due_);
  due_ -= steps;
  StepContext step;
  step.rate = 1.0 - (1.0 - options_.lr_final) * std::min(context.progress, 1.0);
  for (int k = 0; k < steps; ++k) {
    step.number = static_cast<std::uint32_t>(gradient_steps_++);
    DrawBatch(step.number);
    Step(step);
  }
  return Report(steps);
}

void ReplayLearner::Keep(const std::string& name, std::vector<float>* numbers, bool start) {
  kept_.push_back({name, numbers, start});
}

void ReplayLearner::Keep(const std::string& name, AdamState* adam) {
  kept_adams_.emplace_back(name, adam);
}

void ReplayLearner::Save(Archive* archive) const {
  for (const Kept& kept : kept_) archive->Put(kept.name, *kept.numbers);
  for (const auto& [name, adam] : kept_adams_) adam->Save(name, archive);
  archive->Put("observation_moments", observations_.Save());
  archive->Put("state_moments", states_.Save());
  archive->Put("reward_moments", rewards_.Save());
  archive->PutInteger("seen", seen_);
  archive->PutInteger("gradient_steps", gradient_steps_);
  archive->PutNumber("due", due_);
  replay_.Save(archive);
}

void ReplayLearner::LoadMoments(const Archive& archive) {
  const auto& observations = archive.Doubles("observation_moments", observations_.Save().size());
  const auto& states = archive.Doubles("state_moments", states_.Save().size());
  const auto& rewards = archive.Doubles("reward_moments", rewards_.Save().size());
  observations_.Load(observations);
  states_.Load(states);
  rewards_.Load(rewards);
  UpdateScales();
}

void ReplayLearner::Load(const Archive& archive) {
  const std::int64_t seen = archive.Count("seen");
  const std::int64_t steps = archive.Count("gradient_steps");
  const double due = archive.Number("due");
  if (!(due >= 0.0 && due < 1.0)) throw UserError("'due' must be at least 0 and below 1");
  // Everything that may throw comes first, so that an error changes nothing.
  for (const Kept& kept : kept_) archive.Floats(kept.name, kept.numbers->size());
  for (const auto& [name, adam] : kept_adams_) adam->Load(name, archive);
  replay_.Load(archive);
  LoadMoments(archive);
  for (const Kept& kept : kept_) *kept.numbers = archive.Floats(kept.name, kept.numbers->size());
  seen_ = seen;
  gradient_steps_ = steps;
  due_ = due;
}

void ReplayLearner::StartFrom(const Archive& archive) {
  LoadMoments(archive);
  for (const Kept& kept : kept_) {
    if (kept.start) *kept.numbers = archive.Floats(kept.name, kept.numbers->size());
  }
}

void MoveTowards(const std::vector<float>& online, double tau, std::vector<float>* target) {
  const auto t = static_cast<float>(tau);
  float* to = target->data();
  for (std::size_t i = 0; i < online.size(); ++i) to[i] += t * (online[i] - to[i]);
}

}  // namespace stg::learn

#include "marl_trainer/learn/algorithms/on_policy/normalisers.hpp"

#include <algorithm>
#include <cmath>

namespace stg::learn {
namespace {

/// Number of value targets that the value normaliser remembers [environment steps].
constexpr double kValueMemory = 100000.0;

/// The normaliser of a given policy counts as at least this number of observations.
constexpr double kStartCount = 10000.0;

double ValueStd(const RunningMoments& values) { return std::sqrt(values.variance(0)) + 1e-4; }

}  // namespace

Normalisers::Normalisers(const Problem& problem, const PpoOptions& config)
    : std_floor_(static_cast<float>(config.std_floor)),
      clip_(static_cast<float>(config.observation_clip)),
      std_scale_(static_cast<float>(config.std_scale)),
      observations_(problem.observation_size),
      states_(problem.state_size),
      values_(1) {
  UpdateInputScales();
}

void Normalisers::Add(const RunningMoments& observations, const RunningMoments& states) {
  observations_.Merge(observations);
  states_.Merge(states);
}

void Normalisers::UpdateInputScales() {
  scales_.observations = Normaliser::From(observations_, std_floor_, clip_);
  for (float& std : scales_.observations.std) std *= std_scale_;
  scales_.states = Normaliser::From(states_, std_floor_, clip_);
}

void Normalisers::AddTargets(const RunningMoments& targets, const Mlp& critic, float* p) {
  values_.Merge(targets);
  values_.LimitCount(kValueMemory);
  const double mean = values_.mean(0), std = ValueStd(values_);
  const double ratio = static_cast<double>(scales_.value_std) / std;
  RescaleOutputs(critic, ratio, (static_cast<double>(scales_.value_mean) - mean) / std, p);
  scales_.value_mean = static_cast<float>(mean);
  scales_.value_std = static_cast<float>(std);
}

void Normalisers::StartFrom(const agent::Policy& policy, int agents) {
  const agent::Policy::Parameters& p = policy.parameters();
  const double count =
      std::max(kStartCount, static_cast<double>(p.metadata.training_step) * agents);
  std::vector<double> moments{count};
  for (const float mean : p.input_mean) moments.push_back(static_cast<double>(mean));
  for (const float input_std : p.input_std) {
    const double std = static_cast<double>(input_std) / static_cast<double>(std_scale_);
    moments.push_back(count * std * std);
  }
  observations_.Load(moments);
  UpdateInputScales();
}

void Normalisers::Save(Archive* archive) const {
  archive->Put("observation_moments", observations_.Save());
  archive->Put("state_moments", states_.Save());
  archive->Put("value_moments", values_.Save());
}

void Normalisers::Load(const Archive& archive) {
  const auto& observations = archive.Doubles("observation_moments", observations_.Save().size());
  const auto& states = archive.Doubles("state_moments", states_.Save().size());
  const auto& values = archive.Doubles("value_moments", values_.Save().size());
  observations_.Load(observations);
  states_.Load(states);
  values_.Load(values);
  UpdateInputScales();
  scales_.value_mean = static_cast<float>(values_.mean(0));
  scales_.value_std = static_cast<float>(ValueStd(values_));
}

}  // namespace stg::learn

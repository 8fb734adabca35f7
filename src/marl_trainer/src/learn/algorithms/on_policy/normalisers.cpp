#include "marl_trainer/learn/algorithms/on_policy/normalisers.hpp"

#include <cmath>

namespace stg::learn {
namespace {

/// Value targets that the value normaliser remembers [environment steps].
constexpr double kValueMemory = 100000.0;

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
  const int last = critic.layers() - 1;
  for (int i = 0; i < critic.spec().layer_inputs(last); ++i) {
    float& w = p[critic.weight_offset(last) + static_cast<std::size_t>(i)];
    w = static_cast<float>(static_cast<double>(w) * ratio);
  }
  float& bias = p[critic.bias_offset(last)];
  bias = static_cast<float>(static_cast<double>(bias) * ratio +
                            (static_cast<double>(scales_.value_mean) - mean) / std);
  scales_.value_mean = static_cast<float>(mean);
  scales_.value_std = static_cast<float>(std);
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

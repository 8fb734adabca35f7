#include "marl_trainer/learn/nn/adam.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/error.hpp"

namespace stg::learn {

void AdamState::Save(const std::string& name, Archive* archive) const {
  archive->Put(name + "_first", first);
  archive->Put(name + "_second", second);
  archive->PutInteger(name + "_steps", steps);
}

void AdamState::Load(const std::string& name, const Archive& archive) {
  const std::vector<float>& theirs = archive.Floats(name + "_first", first.size());
  const std::vector<float>& squares = archive.Floats(name + "_second", second.size());
  const std::int64_t count = archive.Count(name + "_steps");
  if (std::any_of(squares.begin(), squares.end(), [](float x) { return x < 0.0F; })) {
    throw UserError("'" + name + "_second' has a negative square");
  }
  first = theirs;
  second = squares;
  steps = count;
}

Adam::Adam(double eps, AdamState* state) : state_(state), eps_(static_cast<float>(eps)) {
  ++state_->steps;
  constexpr double kBeta1 = 0.9, kBeta2 = 0.999;
  correction1_ = 1.0 - std::pow(kBeta1, static_cast<double>(state_->steps));
  const double correction2 = 1.0 - std::pow(kBeta2, static_cast<double>(state_->steps));
  root2_ = static_cast<float>(1.0 / std::sqrt(correction2));
}

void Adam::Apply(std::size_t begin, std::size_t end, double learning_rate, float shrink,
                 const float* gradient, float* parameters) const {
  const auto rate = static_cast<float>(learning_rate / correction1_);
  float* p = parameters;
  float* m = state_->first.data();
  float* v = state_->second.data();
  for (std::size_t i = begin; i < end; ++i) {
    const float g = gradient[i] * shrink;
    m[i] = 0.9F * m[i] + 0.1F * g;
    v[i] = 0.999F * v[i] + 0.001F * g * g;
    p[i] -= rate * m[i] / (std::sqrt(v[i]) * root2_ + eps_);
  }
}

double GradientNorm(const float* gradient, std::size_t begin, std::size_t end) {
  double sums[4] = {};
  for (std::size_t i = begin; i < end; ++i) {
    sums[i % 4] += static_cast<double>(gradient[i]) * static_cast<double>(gradient[i]);
  }
  return std::sqrt((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

float ShrinkTo(double limit, double norm) {
  return static_cast<float>(std::min(1.0, limit / (norm + 1e-12)));
}

}  // namespace stg::learn

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "marl_trainer/learn/checkpoint/archive.hpp"

namespace stg::learn {

/// Adam's memory of one flat array of parameters; moments [parameters].
struct AdamState {
  AdamState() = default;
  explicit AdamState(std::size_t parameters) : first(parameters, 0.0F), second(parameters, 0.0F) {}

  /// As arrays name_first, name_second and name_steps.
  void Save(const std::string& name, Archive* archive) const;
  /// Throws UserError for another number of parameters, and for moments and steps that cannot be.
  void Load(const std::string& name, const Archive& archive);

  std::vector<float> first, second;
  std::int64_t steps = 0;
};

/// Steps of Adam (Kingma and Ba 2015, beta 0.9 and 0.999) on ranges of the array, so that groups of
/// parameters have rates of their own and workers share the work.
class Adam {
 public:
  /// Begins the next step.
  Adam(double eps, AdamState* state);

  /// @param shrink multiplies the gradient first (clipping by its norm).
  void Apply(std::size_t begin, std::size_t end, double learning_rate, float shrink,
             const float* gradient, float* parameters) const;

 private:
  AdamState* state_;
  float eps_, root2_;
  double correction1_;
};

/// Euclidean norm of gradient[begin, end).
double GradientNorm(const float* gradient, std::size_t begin, std::size_t end);
/// Factor that brings a gradient of this norm down to at most `limit`.
float ShrinkTo(double limit, double norm);

}  // namespace stg::learn

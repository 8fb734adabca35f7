#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "marl_trainer/learn/checkpoint/archive.hpp"

namespace stg::learn {

/// State of Adam for one flat array of parameters; moments [parameters].
struct AdamState {
  AdamState() = default;
  explicit AdamState(std::size_t parameters) : first(parameters, 0.0F), second(parameters, 0.0F) {}

  /// Stores the arrays name_first, name_second and name_steps.
  void Save(const std::string& name, Archive* archive) const;
  /// Throws UserError if the number of parameters differs, or if moments or steps are impossible.
  void Load(const std::string& name, const Archive& archive);

  std::vector<float> first, second;
  std::int64_t steps = 0;
};

/// Steps of Adam (Kingma and Ba 2015, beta 0.9 and 0.999) on ranges of the array. So groups of
/// parameters can have their own learning rates, and workers can share the work.
class Adam {
 public:
  /// Begins the next step.
  Adam(double eps, AdamState* state);

  /// @param shrink factor of the gradient before the step (clipping by its norm).
  void Apply(std::size_t begin, std::size_t end, double learning_rate, float shrink,
             const float* gradient, float* parameters) const;

 private:
  AdamState* state_;
  float eps_, root2_;
  double correction1_;
};

/// Euclidean norm of gradient[begin, end).
double GradientNorm(const float* gradient, std::size_t begin, std::size_t end);
/// Factor that reduces a gradient of this norm to at most `limit`.
float ShrinkTo(double limit, double norm);

}  // namespace stg::learn

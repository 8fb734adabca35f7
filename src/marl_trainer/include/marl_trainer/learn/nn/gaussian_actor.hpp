#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/nn/mlp.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"
#include "stg_agent/policy/policy.hpp"

namespace stg::learn {

/// Smallest log sigma in a policy file; it stands for no spread.
constexpr float kNoSpread = -20.0F;

/// The actor of Eq. 37: a Gaussian. Its mean is a network of one AUV's normalised observation,
/// squashed to the action's scale. Its standard deviation does not depend on the state. The
/// parameters are in one flat array: the network, then log sigma [action_size].
class GaussianActor {
 public:
  /// @param mean its squash is the action's scale and must be positive.
  explicit GaussianActor(NetworkSpec mean);

  const Mlp& mean() const { return mean_; }
  int inputs() const { return mean_.inputs(); }
  int action_size() const { return mean_.outputs(); }
  float action_scale() const { return mean_.spec().squash; }
  std::size_t log_std_offset() const { return mean_.parameters(); }
  std::size_t parameters() const {
    return log_std_offset() + static_cast<std::size_t>(action_size());
  }

  void Initialise(std::uint64_t seed, std::uint32_t network, double log_std,
                  float* parameters) const;

  /// The policy with these parameters and the observation normaliser. A log sigma below kNoSpread,
  /// from a small action scale, is stored as kNoSpread.
  agent::Policy ToPolicy(const float* parameters, const Normaliser& observations,
                         agent::PolicyMetadata metadata) const;
  /// Writes the parameters of a policy with the same shape.
  void FromPolicy(const agent::Policy& policy, float* parameters) const;

 private:
  Mlp mean_;
};

}  // namespace stg::learn

#include "stg_env/task/reward_term.hpp"

namespace stg::task {
namespace {

/// Minus the mean square of the six tau / tau_max: the force of a decision, with any action
/// interface. In [-1, 0].
struct EffortTerm : TermOf<EffortTerm> {
  template <class T>
  T Of(const TermInput<T>& in) const {
    T sum(0.0);
    for (const T& fraction : in.swarm.tau[static_cast<std::size_t>(in.agent)]) {
      sum += fraction * fraction;
    }
    return sum * T(-1.0 / dynamics::kWrenchSize);
  }
};

std::unique_ptr<const RewardTerm> MakeEffortTerm(const JudgeConfig&) {
  return std::make_unique<EffortTerm>();
}

}  // namespace

RewardTermRegistry::Entry EffortTermEntry() { return {"effort", MakeEffortTerm}; }

}  // namespace stg::task

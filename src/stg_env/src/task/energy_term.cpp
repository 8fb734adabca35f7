#include "stg_env/task/reward_term.hpp"

namespace stg::task {
namespace {

/// Minus the cube of the first actuator's share of its limit. For a propeller or a commanded speed,
/// the power of propulsion is proportional to it. In [-1, 0].
struct EnergyTerm : TermOf<EnergyTerm> {
  template <class T>
  T Of(const TermInput<T>& in) const {
    const T share = Abs(in.swarm.tau[static_cast<std::size_t>(in.agent)][0]);
    return -(share * share * share);
  }
};

std::unique_ptr<const RewardTerm> MakeEnergyTerm(const JudgeConfig&) {
  return std::make_unique<EnergyTerm>();
}

}  // namespace

RewardTermRegistry::Entry EnergyTermEntry() { return {"energy", MakeEnergyTerm}; }

}  // namespace stg::task

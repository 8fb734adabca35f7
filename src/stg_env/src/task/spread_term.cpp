#include "stg_env/task/field_totals.hpp"
#include "stg_env/task/reward_term.hpp"

namespace stg::task {
namespace {

/// How evenly the AUVs with the same target are distributed around it (Spread), in [0, 1].
struct SpreadTerm : TermOf<SpreadTerm> {
  template <class T>
  T Of(const TermInput<T>& in) const {
    const auto u = static_cast<std::size_t>(in.agent);
    const std::size_t targets = in.swarm.targets.size();
    if (in.swarm.following == nullptr) return Spread(in.swarm, static_cast<int>(u % targets));
    T spread(0.0);
    for (std::size_t t = 0; t < targets; ++t) {
      const auto own = in.swarm.following->target[u] == T(static_cast<double>(t));
      spread = Select(own, Spread(in.swarm, static_cast<int>(t)), spread);
    }
    return spread;
  }
};

std::unique_ptr<const RewardTerm> MakeSpreadTerm(const JudgeConfig&) {
  return std::make_unique<SpreadTerm>();
}

}  // namespace

RewardTermRegistry::Entry SpreadTermEntry() { return {"spread", MakeSpreadTerm}; }

}  // namespace stg::task

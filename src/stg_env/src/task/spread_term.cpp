#include "stg_env/task/field_totals.hpp"
#include "terms.hpp"

namespace stg::task {
namespace {

/// How evenly the AUVs of the same target stand around it (Spread), in [0, 1].
struct SpreadTerm : TermOf<SpreadTerm> {
  explicit SpreadTerm(const dynamics::TargetConfig& targets) : targets_(targets) {}

  template <class T>
  T Of(const TermInput<T>& in) const {
    return Spread(in.swarm, targets_.of(in.agent));
  }

 private:
  dynamics::TargetConfig targets_;
};

}  // namespace

std::unique_ptr<const RewardTerm> MakeSpreadTerm(const JudgeConfig& scenario) {
  return std::make_unique<SpreadTerm>(scenario.world.target);
}

}  // namespace stg::task

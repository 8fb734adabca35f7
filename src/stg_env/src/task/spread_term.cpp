#include "stg_env/task/field_totals.hpp"
#include "terms.hpp"

namespace stg::task {
namespace {

/// How evenly the AUVs of the same target stand around it (Spread), in [0, 1].
struct SpreadTerm : TermOf<SpreadTerm> {
  explicit SpreadTerm(const JudgeConfig& scenario) : scenario_(scenario) {}

  template <class T>
  T Of(const TermInput<T>& in) const {
    return Spread(scenario_, in.swarm, scenario_.target_of(in.agent));
  }

 private:
  JudgeConfig scenario_;
};

}  // namespace

std::unique_ptr<const RewardTerm> MakeSpreadTerm(const JudgeConfig& scenario) {
  return std::make_unique<SpreadTerm>(scenario);
}

}  // namespace stg::task

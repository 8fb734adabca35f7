#include "stg_env/task/judge_config.hpp"
#include "terms.hpp"

namespace stg::task {
namespace {

/// What the own estimate of the target is worth: 1 where it is off by 10 m or less, falling to 0 at
/// 50 m, as UTracking rewards it (arXiv 2505.08222); 0 without an estimate or open water.
struct EstimateTerm : TermOf<EstimateTerm> {
  explicit EstimateTerm(const dynamics::TargetConfig& targets) : targets_(targets) {}

  template <class T>
  T Of(const TermInput<T>& in) const {
    if (in.swarm.field == nullptr) return T(0.0);
    const FieldState<T>& f = (*in.swarm.field)[static_cast<std::size_t>(in.agent)];
    const auto target = static_cast<std::size_t>(targets_.of(in.agent));
    const T error = Norm(f.p_WT - in.swarm.targets[target].p_WT);
    return f.known * Clip((T(50.0) - error) * T(1.0 / 40.0), T(0.0), T(1.0));
  }

 private:
  dynamics::TargetConfig targets_;
};

}  // namespace

std::unique_ptr<const RewardTerm> MakeEstimateTerm(const JudgeConfig& scenario) {
  return std::make_unique<EstimateTerm>(scenario.world.target);
}

}  // namespace stg::task

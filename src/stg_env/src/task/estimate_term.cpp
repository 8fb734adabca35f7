#include "stg_env/task/judge_config.hpp"
#include "stg_env/task/reward_term.hpp"

namespace stg::task {
namespace {

/// Defaults are from the reward of estimates in UTracking (arXiv 2505.08222).
struct EstimateOptions {
  double good_m = 10.0, fall_m = 40.0;
};

void Describe(EstimateOptions* o, config::Table* t) {
  t->Add("good_m", &o->good_m, config::NonNegative(1e5), "m",
         "an estimate with an error up to this earns the whole term");
  t->Add("fall_m", &o->fall_m, config::Positive(1e5), "m",
         "the reward falls to 0 over this further error");
}

/// Value of the own estimate of the target: 1 if its error is at most `good_m`, then falling to 0
/// within another `fall_m`. 0 without an estimate or open water.
struct EstimateTerm : TermOf<EstimateTerm> {
  explicit EstimateTerm(const EstimateOptions& options) : options_(options) {}

  template <class T>
  T Of(const TermInput<T>& in) const {
    if (in.swarm.field == nullptr) return T(0.0);
    const FieldState<T>& f = (*in.swarm.field)[static_cast<std::size_t>(in.agent)];
    const T error = Norm(f.p_WT - in.swarm.target_of(static_cast<std::size_t>(in.agent)).p_WT);
    return f.known * Clip((T(options_.good_m + options_.fall_m) - error) * T(1.0 / options_.fall_m),
                          T(0.0), T(1.0));
  }

 private:
  EstimateOptions options_;
};

std::unique_ptr<const RewardTerm> MakeEstimateTerm(const EstimateOptions& options,
                                                   const JudgeConfig&) {
  return std::make_unique<EstimateTerm>(options);
}

}  // namespace

RewardTermRegistry::Entry EstimateTermEntry() { return {"estimate", MakeEstimateTerm}; }

}  // namespace stg::task

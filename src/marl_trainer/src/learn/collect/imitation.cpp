#include "marl_trainer/learn/collect/imitation.hpp"

#include <algorithm>

namespace stg::learn {

void ImitationConfig::Describe(config::Table* table) {
  table->Add("imitate", config::TextRef{&controller}, config::kNone, "-",
             "built-in controller whose actions the policy first learns, with constants if need "
             "be, as in pursuit_separated:gain=2,cap=0.5; empty: none");
  table->Add("imitation-steps", &steps, {0, 1e12}, "-",
             "environment steps of imitation: in full for the first half, then fading into the "
             "return");
  table->Add("imitation-share", &share, {0, 1}, "-",
             "share of the actor's loss that is imitation where it is in full");
  table->Add("imitation-focus", &focus, {0, 4}, "-",
             "misses weigh by the size of the teacher's action, in sigmas, to minus this power: 0 "
             "all alike, 2 little more than the hold");
  table->Add("privileged-teacher", &privileged, config::kNone, "-",
             "the controller to imitate reads true states, as the critic does; the policy never "
             "does");
}

void ImitationConfig::ValidateOrThrow() const {
  RequireOption(controller.empty() == (steps == 0), "imitation-steps",
                "goes with --imitate, and the other way round");
}

double ImitationConfig::Weight(std::int64_t env_steps) const {
  if (controller.empty()) return 0.0;
  const double left =
      1.0 - static_cast<double>(env_steps) / static_cast<double>(std::max<std::int64_t>(1, steps));
  return share * std::min(std::max(2.0 * left, 0.0), 1.0);
}

}  // namespace stg::learn

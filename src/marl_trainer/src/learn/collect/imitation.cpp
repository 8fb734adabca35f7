#include "marl_trainer/learn/collect/imitation.hpp"

#include <algorithm>

namespace stg::learn {

void ImitationConfig::Describe(config::Table* table) {
  table->Add("imitate", config::TextRef{&controller}, config::kNone, "-",
             "built-in controller whose actions the policy imitates at first, with its constants "
             "if needed, for example pursuit_separated:gain=2,cap=0.5; empty: none");
  table->Add(
      "imitation-steps", &steps, {0, 1e12}, "-",
      "environment steps of imitation: with full weight in the first half, then falling to 0");
  table->Add("imitation-share", &share, {0, 1}, "-",
             "share of imitation in the actor's loss while it has full weight");
  table->Add(
      "imitation-focus", &focus, {0, 4}, "-",
      "an error is weighted by the size of the teacher's action (in sigmas) to the power of minus "
      "this value; 0: all errors count equally; 2: mainly those of small actions count");
  table->Add("privileged-teacher", &privileged, config::kNone, "-",
             "the imitated controller reads true states, as the critic does; the policy does not");
  const config::Owner imitating{"training", {"with imitation"}, "imitate", [this] {
                                  return std::vector<std::string>{
                                      controller.empty() ? "without imitation" : "with imitation"};
                                }};
  for (const char* option :
       {"imitation-steps", "imitation-share", "imitation-focus", "privileged-teacher"}) {
    table->Own(option, imitating);
  }
}

void ImitationConfig::ValidateOrThrow() const {
  RequireOption(controller.empty() || share > 0.0, "imitation-share",
                "must be above 0 with --imitate; a training without imitation leaves both out");
  RequireOption(controller.empty() == (steps == 0), "imitation-steps",
                "--imitation-steps and --imitate must be given together");
}

double ImitationConfig::Weight(std::int64_t env_steps) const {
  if (controller.empty()) return 0.0;
  const double left =
      1.0 - static_cast<double>(env_steps) / static_cast<double>(std::max<std::int64_t>(1, steps));
  return share * std::min(std::max(2.0 * left, 0.0), 1.0);
}

}  // namespace stg::learn

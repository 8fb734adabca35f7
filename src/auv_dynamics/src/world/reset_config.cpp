#include "auv_dynamics/world/reset_config.hpp"

namespace stg::dynamics {

using config::Enum;
using config::kNone;
using config::NonNegative;
using config::Positive;

void Describe(ResetConfig* c, config::Table* t) {
  t->Section("reset");
  t->Add("stage", config::Enum(&c->stage, {"easy", "medium", "hard"}), config::kNone, "-",
         "reset stage of evaluation and of training without a curriculum");
  t->AddOptional(
      "deploy", config::Enum(&c->deploy, {"around", "point", "area"}), "around", config::kNone, "-",
      "around: AUVs start around their targets; point: on a line, reset.min_separation_m apart, "
      "whose middle is reset.stages.*.auv_distance_m from the first target; area: anywhere within "
      "reset.start_half_extent_m. point and area need sea.open");
  t->Add("curriculum", &c->curriculum, config::kNone, "-",
         "training draws the stage from the number of resets: easy, medium, then hard");
  const auto training = [c] {
    return std::vector<std::string>{c->curriculum ? "curriculum" : "one stage"};
  };
  t->Thing({"training", {"curriculum"}, "reset.curriculum", training}, "reset", c,
           [](ResetConfig* o, config::Table* table) {
             table->Add("curriculum_easy_resets", &o->curriculum_easy_resets,
                        config::NonNegative(1e9), "resets",
                        "curriculum: resets up to this number are easy");
             table->Add("curriculum_medium_resets", &o->curriculum_medium_resets,
                        config::NonNegative(1e9), "resets",
                        "curriculum: resets up to this number are medium, later ones hard");
           });
  t->Add("min_separation_m", &c->min_separation_m, config::NonNegative(1e4), "m",
         "AUVs start at least this far from each other");
  t->Add("start_half_extent_m", &c->start_half_extent_m, config::Positive(1e5), "m, world ENU",
         "AUVs start within +- this value on each axis");
  const char* names[] = {"easy", "medium", "hard"};
  for (std::size_t i = 0; i < c->stages.size(); ++i) {
    t->Section(std::string("reset.stages.") + names[i]);
    t->Add("target_radius_m", &c->stages[i].target_radius_m, config::NonNegative(1e5), "m",
           "[low, high] distance of a target from the origin of the world");
    t->Add("auv_distance_m", &c->stages[i].auv_distance_m, config::NonNegative(1e5), "m",
           "[low, high] distance of an AUV from its target");
    t->Add("target_speed_mps", &c->stages[i].target_speed_mps, config::NonNegative(10), "m/s",
           "[low, high] speed of a target, in a uniformly drawn direction");
  }
}

}  // namespace stg::dynamics

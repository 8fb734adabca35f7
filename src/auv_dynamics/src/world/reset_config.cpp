#include "auv_dynamics/world/reset_config.hpp"

namespace stg::dynamics {

using config::Enum;
using config::kNone;
using config::NonNegative;
using config::Positive;

namespace {

const std::vector<std::string> kStageNames{"easy", "medium", "hard"};

/// The keys of a stage have no effect while no episode starts in this stage, and the distance from
/// the target has none if vehicles start anywhere.
void OwnStages(ResetConfig* c, config::Table* t) {
  const config::Owner deployment{
      "start", {"around", "point"}, "reset.deploy", [c] {
        const char* const names[] = {"around", "point", "area"};
        return std::vector<std::string>{names[static_cast<std::size_t>(c->deploy)]};
      }};
  const auto chosen = [c] {
    return c->curriculum
               ? kStageNames
               : std::vector<std::string>{kStageNames[static_cast<std::size_t>(c->stage)]};
  };
  for (const std::string& name : kStageNames) {
    const std::string section = "reset.stages." + name;
    t->Own(section + ".auv_distance_m", deployment);
    config::Owner stage{"reset stage", {name}, "reset.stage", chosen, {"reset.curriculum"}};
    stage.files_state_all = true;  // conditions and the curriculum choose other stages
    t->Own(section, stage);
  }
}

}  // namespace

void Describe(ResetConfig* c, config::Table* t) {
  t->Section("reset");
  t->Add("stage", config::Enum(&c->stage, kStageNames), config::kNone, "-",
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
  for (std::size_t i = 0; i < c->stages.size(); ++i) {
    t->Section("reset.stages." + kStageNames[i]);
    t->Add("target_radius_m", &c->stages[i].target_radius_m, config::NonNegative(1e5), "m",
           "[low, high] distance of a target from the origin of the world");
    t->Add("auv_distance_m", &c->stages[i].auv_distance_m, config::NonNegative(1e5), "m",
           "[low, high] distance of an AUV from its target");
    t->Add("target_speed_mps", &c->stages[i].target_speed_mps, config::NonNegative(10), "m/s",
           "[low, high] speed of a target, in a uniformly drawn direction");
  }
  OwnStages(c, t);
}

}  // namespace stg::dynamics

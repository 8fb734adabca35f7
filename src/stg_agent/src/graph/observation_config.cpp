#include "stg_agent/graph/observation_config.hpp"

#include <map>
#include <string>
#include <vector>

namespace stg::agent {

void Describe(ObservationConfig* c, config::Table* t) {
  t->Section("observation");
  t->Add("tracking", &c->tracking, config::kNone, "-", "include the 8 tracking numbers of Eq. 14");
  t->Add("semantic", &c->semantic, config::kNone, "-",
         "include the 9 semantic numbers of Eqs. 15-16");
  t->Add("graph", &c->graph, config::kNone, "-", "include the 6 task-graph numbers of Eq. 18");
  t->AddOptional("links", &c->links, "true", config::kNone, "-",
                 "the link numbers of Eq. 18; false: they read 0, for an ablation");
  t->AddOptional("roles", &c->roles, "true", config::kNone, "-",
                 "advantage and role of Eqs. 18-19; false: they read 0, for an ablation");
  t->Add("order", config::Enum(&c->order, {"nearest", "index"}), config::kNone, "-",
         "the three neighbours in the observation: the nearest, or the first by index");
  t->Add("release_bookkeeping", &c->release_bookkeeping, config::kNone, "-",
         "truth mode, errors of the release: observed progress and first P are 0, the mean error "
         "counts the current one twice, lost steps are one too many");
  t->Add("distance_scale_m", &c->distance_scale_m, config::Positive(1e5), "m",
         "target distance that reads 1");
  t->Add("error_scale_m", &c->error_scale_m, config::Positive(1e5), "m",
         "tracking error that reads 1");
  t->Add("progress_scale_m", &c->progress_scale_m, config::Positive(1e4), "m",
         "approach in one decision that reads 1");
  t->Add("closing_scale_mps", &c->closing_scale_mps, config::Positive(100), "m/s",
         "closing speed that reads 1");
  t->Add("error_window", &c->error_window, config::Within(1, 64), "decisions",
         "length k of the running mean of the tracking error");
  t->Add("lost_scale_steps", &c->lost_scale_steps, config::Positive(1e6), "decisions",
         "consecutive lost decisions that read 1");
  t->Add("near_range_m", &c->near_range_m, config::NonNegative(1e5), "m",
         "an approach closer to the target than this counts as stable");
  t->Add("quality_high", &c->quality_high, config::kFraction, "-",
         "a confidence of this value or more is high");
  t->Add("quality_medium", &c->quality_medium, config::kFraction, "-",
         "a confidence of this value or more is medium, a smaller one is low");
  t->Add("link_available", &c->link_available, config::kFraction, "-",
         "a neighbour is effective when its link quality is above this");
  t->Add("role_confidence", &c->role_confidence, config::kFraction, "-",
         "smallest confidence with which an AUV with an advantage takes the tracking role");
  const config::Owner graph{"task graph", {"true"}, "observation.graph", [c] {
                              return std::vector<std::string>{c->graph ? "true" : "false"};
                            }};
  t->Own("observation.links", graph);
  t->Own("observation.roles", graph);
  t->Own("observation.role_confidence",
         {"roles", {"true"}, "observation.roles", [c] {
            return std::vector<std::string>{c->roles ? "true" : "false"};
          }});
  const config::Owner tracking{"tracking numbers", {"true"}, "observation.tracking", [c] {
                                 return std::vector<std::string>{c->tracking ? "true" : "false"};
                               }};
  for (const char* key : {"distance_scale_m", "lost_scale_steps"}) {
    t->Own(std::string("observation.") + key, tracking);
  }
  t->Own("observation.link_available", graph);
  const config::Owner derived{"derived numbers",
                              {"tracking", "semantic", "graph"},
                              "observation.tracking",
                              [c] {
                                std::vector<std::string> parts;
                                if (c->tracking) parts.emplace_back("tracking");
                                if (c->semantic) parts.emplace_back("semantic");
                                if (c->graph) parts.emplace_back("graph");
                                return parts;
                              },
                              {"observation.semantic", "observation.graph"},
                              true};
  for (const char* key : {"error_scale_m", "error_window", "quality_high", "quality_medium"}) {
    t->Own(std::string("observation.") + key, derived);
  }
  t->Moved("observation.link_radius_m", "channel.range_m");
}

ObservationReader ReaderOf(const std::string& key) {
  using R = ObservationReader;
  static const std::map<std::string, R> readers = {
      {"observation.tracking", R::kVectorPolicy},
      {"observation.semantic", R::kVectorPolicy},
      {"observation.graph", R::kVectorPolicy},
      {"observation.links", R::kPolicy},
      {"observation.roles", R::kPolicy},
      {"observation.order", R::kVectorPolicy},
      {"observation.release_bookkeeping", R::kTask},
      {"observation.distance_scale_m", R::kVectorPolicy},
      {"observation.error_scale_m", R::kPolicy},
      {"observation.progress_scale_m", R::kTask},
      {"observation.closing_scale_mps", R::kTask},
      {"observation.error_window", R::kPolicy},
      {"observation.lost_scale_steps", R::kVectorPolicy},
      {"observation.near_range_m", R::kTask},
      {"observation.quality_high", R::kPolicy},
      {"observation.quality_medium", R::kPolicy},
      {"observation.link_available", R::kVectorPolicy},
      {"observation.role_confidence", R::kPolicy}};
  return readers.at(key);
}

}  // namespace stg::agent

#include "stg_agent/agent/agent_config.hpp"

namespace stg::agent {

using config::Enum;
using config::kFraction;
using config::kNone;
using config::NonNegative;
using config::Positive;
using config::Within;

void Describe(TrackConfig* c, config::Table* t) {
  t->Section("track");
  t->Add("process_accel_std_mps2", &c->process_accel_std_mps2, config::Positive(100), "m/s^2",
         "acoustic mode: white acceleration of the target model");
  t->Add("measurement_std_m", &c->measurement_std_m, config::Positive(1e4), "m",
         "smallest standard deviation given to a detection");
  t->Add("initial_speed_std_mps", &c->initial_speed_std_mps, config::Positive(100), "m/s",
         "standard deviation of each velocity component of a new track");
  t->Add("gate_sigma", &c->gate_sigma, config::Positive(1e3), "-",
         "own detections farther off are set aside, three in a row restart the track");
  t->Add("lost_std_m", &c->lost_std_m, config::Positive(1e4), "m",
         "a track whose position is no better than this counts as lost");
  t->Add("neighbour_max_age_s", &c->neighbour_max_age_s, config::Positive(1e5), "s",
         "a neighbour is forgotten after this silence");
}

void Describe(ObservationConfig* c, config::Table* t) {
  t->Section("observation");
  t->Add("tracking", &c->tracking, config::kNone, "-", "include the 8 tracking numbers of Eq. 14");
  t->Add("semantic", &c->semantic, config::kNone, "-",
         "include the 9 semantic numbers of Eqs. 15-16");
  t->Add("graph", &c->graph, config::kNone, "-", "include the 6 task-graph numbers of Eq. 18");
  t->Add("order", config::Enum(&c->order, {"nearest", "index"}), config::kNone, "-",
         "which three neighbours are shown: the nearest, or the first by index");
  t->Add(
      "release_bookkeeping", &c->release_bookkeeping, config::kNone, "-",
      "truth mode, as the release: shown progress and first P are 0, mean error counts the current "
      "one twice, lost steps read one too many");
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
         "closer to the target than this, an approach counts as stable");
  t->Add("quality_high", &c->quality_high, config::kFraction, "-",
         "confidence from here on is high");
  t->Add("quality_medium", &c->quality_medium, config::kFraction, "-",
         "confidence from here on is medium, below it low");
  t->Add("link_available", &c->link_available, config::kFraction, "-",
         "a link quality above this makes an effective neighbour");
  t->Add("role_confidence", &c->role_confidence, config::kFraction, "-",
         "confidence from which an AUV with an advantage takes the tracking role");
  t->Moved("observation.link_radius_m", "channel.range_m");
}

void Describe(TaskConfig* c, config::Table* t) {
  t->Section("task");
  t->Add("desired_distance_m", &c->desired_distance_m, config::NonNegative(1e4), "m",
         "desired distance d* from the target");
  t->Add("lost_distance_m", &c->lost_distance_m, config::Positive(1e5), "m",
         "farther from the target than this, it counts as lost");
  t->Moved("reward.desired_distance_m", "task.desired_distance_m");
  t->Moved("reward.lost_distance_m", "task.lost_distance_m");
}

void Describe(AgentConfig* c, config::Table* t) {
  Describe(static_cast<dynamics::WorldConfig*>(c), t);
  Describe(&c->channel, t);
  Describe(&c->track, t);
  Describe(&c->observation, t);
  Describe(&c->task, t);
}

std::optional<config::Violation> FindConflict(const AgentConfig& c) {
  if (auto violation = FindConflict(static_cast<const dynamics::WorldConfig&>(c))) {
    return violation;
  }
  if (auto violation = FindConflict(c.channel, c)) return violation;
  if (c.observation.quality_medium > c.observation.quality_high) {
    return config::Violation{{"observation.quality_medium", "observation.quality_high"},
                             "medium quality cannot begin above high quality"};
  }
  return {};
}

}  // namespace stg::agent

#include "marl_trainer/task/reward_config.hpp"

namespace stg::task {

using config::Enum;
using config::kFraction;
using config::kNone;
using config::NonNegative;
using config::Numbers;
using config::Positive;
using config::Within;

void Describe(RewardConfig* c, config::Table* t) {
  t->Section("reward");
  t->Add("kind", Enum(&c->kind, {"paper", "release", "release_raw"}), kNone, "-",
         "Eqs. 28-36, the release's reward, or that of its raw baselines");
  t->Section("reward.weights");
  RewardWeights* w = &c->weights;
  t->Add("tracking", &w->tracking, NonNegative(1e3), "-", "weight of the tracking term");
  t->Add("observation", &w->observation, NonNegative(1e3), "-", "weight of the observation term");
  t->Add("coordination", &w->coordination, NonNegative(1e3), "-",
         "weight of the coordination term");
  t->Add("communication", &w->communication, NonNegative(1e3), "-",
         "weight of the communication term");
  t->Add("semantic", &w->semantic, NonNegative(1e3), "-", "weight of the semantic term");
  t->Add("control_cost", &w->control_cost, NonNegative(1e3), "-",
         "weight of the control cost, which is subtracted");
  t->Add("separation", &w->separation, NonNegative(1e3), "-",
         "weight of the penalty for closeness to another AUV; 0 in the paper");
  t->Section("reward");
  t->Add("band_m", &c->band_m, Positive(1e4), "m", "[d_l, d_u]: tracking band");
  t->Add("error_max_m", &c->error_max_m, Positive(1e5), "m", "e_max: error that earns nothing");
  t->Add("w_band", &c->w_band, NonNegative(1e3), "-", "Eq. 30: weight of the band term");
  t->Add("w_progress", &c->w_progress, NonNegative(1e3), "-", "Eq. 30: weight of progress");
  t->Add("w_closing", &c->w_closing, NonNegative(1e3), "-", "Eq. 30: weight of closing speed");
  t->Add("w_reacquire", &c->w_reacquire, NonNegative(1e3), "-", "Eq. 30: weight of reacquisition");
  t->Add("w_too_close", &c->w_too_close, NonNegative(1e3), "-",
         "Eq. 30: weight of the penalty inside d_l");
  t->Add("separation_distance_m", &c->separation_distance_m, Positive(1e4), "m",
         "separation penalty: none beyond this distance of two AUVs");
  t->Add("total_limit", &c->total_limit, Positive(1e6), "-",
         "an agent's total reward is clipped to +- this value");
}

}  // namespace stg::task

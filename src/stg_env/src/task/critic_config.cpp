#include "stg_env/task/judge_config.hpp"

namespace stg::task {

void Describe(CriticConfig* c, config::Table* t) {
  t->Section("critic");
  t->AddOptional("far_scale_m", &c->far_scale_m, "1.0", config::Positive(1e5), "m",
                 "critic's state: a position or an offset of this length reads 1");
  t->AddOptional(
      "near_scale_m", &c->near_scale_m, "0.05", config::Positive(1e5), "m",
      "critic's state: length at which an offset near the band reads 1, its largest value");
  t->AddOptional("target_speed_gain", &c->target_speed_gain, "20.0", config::Positive(1e3), "-",
                 "critic's state: a target this many times slower than the fastest AUV reads 1");
}

}  // namespace stg::task

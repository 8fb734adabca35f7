#include "marl_trainer/learn/algorithms/happo/happo_config.hpp"

#include "auv_common/error.hpp"
#include "marl_trainer/learn/algorithms/happo/happo.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {

void HappoConfig::Describe(config::Table* t) {
  PpoConfig::Describe(t);
  t->Add("sequential", &sequential, config::kNone, "-",
         "each AUV's update takes the earlier updates of other AUVs into account; off: MAPPO with "
         "an actor for each AUV");
}

void HappoConfig::ApplyRecordings(const TrainConfig&) {
  throw UserError("happo does not learn from recordings: its AUVs fly with policies of their own");
}

void HappoConfig::FitPolicy(const agent::Policy&) {
  throw UserError("happo cannot start from one policy: its AUVs fly with policies of their own");
}

std::unique_ptr<Algorithm> HappoConfig::Make(const TrainConfig& common, const Problem& problem,
                                             const Team& team) const {
  return std::make_unique<Happo>(*this, common, problem, team);
}

}  // namespace stg::learn

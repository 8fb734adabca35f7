#pragma once

#include <memory>

#include "stg_env/task/reward_term.hpp"

/// The suite's own reward terms, a file each.
namespace stg::task {

/// Of the term `estimate`, as UTracking rewards an estimate (arXiv 2505.08222).
struct EstimateOptions {
  double good_m = 10.0, fall_m = 40.0;
};
void Describe(EstimateOptions* o, config::Table* t);
/// Of `obstacle`: the turning circle of a torpedo.
struct ObstacleOptions {
  double margin_m = 25.0;
};
void Describe(ObstacleOptions* o, config::Table* t);
/// Of `seabed`: what survey vehicles keep over rough ground.
struct SeabedOptions {
  double margin_m = 10.0;
};
void Describe(SeabedOptions* o, config::Table* t);

std::unique_ptr<const RewardTerm> MakeEffortTerm(const JudgeConfig& scenario);
std::unique_ptr<const RewardTerm> MakeEnergyTerm(const JudgeConfig& scenario);
std::unique_ptr<const RewardTerm> MakeEstimateTerm(const EstimateOptions& options,
                                                   const JudgeConfig& scenario);
std::unique_ptr<const RewardTerm> MakeObstacleTerm(const ObstacleOptions& options,
                                                   const JudgeConfig& scenario);
std::unique_ptr<const RewardTerm> MakeSeabedTerm(const SeabedOptions& options,
                                                 const JudgeConfig& scenario);
std::unique_ptr<const RewardTerm> MakeSpreadTerm(const JudgeConfig& scenario);

}  // namespace stg::task

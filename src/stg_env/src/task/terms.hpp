#pragma once

#include <memory>

#include "stg_env/task/reward_term.hpp"

/// The suite's own reward terms, a file each.
namespace stg::task {

std::unique_ptr<const RewardTerm> MakeEffortTerm(const JudgeConfig& scenario);
std::unique_ptr<const RewardTerm> MakeEnergyTerm(const JudgeConfig& scenario);
std::unique_ptr<const RewardTerm> MakeEstimateTerm(const JudgeConfig& scenario);
std::unique_ptr<const RewardTerm> MakeObstacleTerm(const JudgeConfig& scenario);
std::unique_ptr<const RewardTerm> MakeSeabedTerm(const JudgeConfig& scenario);
std::unique_ptr<const RewardTerm> MakeSpreadTerm(const JudgeConfig& scenario);

}  // namespace stg::task

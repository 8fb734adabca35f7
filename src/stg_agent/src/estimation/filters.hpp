#pragma once

#include <memory>

#include "stg_agent/estimation/target_filter.hpp"

/// The filters of this package: docs/estimation.md describes them, their code stands in the files
/// of their names.
namespace stg::agent {

std::unique_ptr<TargetFilter> MakeKalmanFilter(const AgentModel& model, const int& self);
std::unique_ptr<TargetFilter> MakeMeasurementFilter(const AgentModel& model, const int& self);

}  // namespace stg::agent

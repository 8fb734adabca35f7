#pragma once

#include <string>

#include "stg_agent/policy/policy.hpp"

/// What the writer and the reader of policy files share.
namespace stg::agent {

/// FNV-1a over every number of the policy, hexadecimal, to tell a damaged file
/// from a good one.
std::string PolicyChecksum(const Policy::Parameters& parameters);

inline constexpr char kMetricPrefix[] = "stg.metric.";

}  // namespace stg::agent

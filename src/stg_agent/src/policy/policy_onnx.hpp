#pragma once

#include <string>

#include "stg_agent/policy/policy.hpp"

/// What the writer and the reader of policy files share.
namespace stg::agent {

/// FNV-1a over everything that a policy file says, hexadecimal, to tell a damaged file from a good
/// one; "2:" before it tells it from the one below.
std::string PolicyChecksum(const Policy::Parameters& parameters);
/// Over the numbers alone, as files have it that were written before the metadata was covered.
std::string NumbersChecksum(const Policy::Parameters& parameters);

inline constexpr char kMetricPrefix[] = "stg.metric.";

}  // namespace stg::agent

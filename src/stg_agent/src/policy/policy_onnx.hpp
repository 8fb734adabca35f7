#pragma once

#include <string>

#include "stg_agent/policy/policy.hpp"

/// Parts that the writer and the reader of policy files share.
namespace stg::agent {

/// FNV-1a of the whole content of a policy file, hexadecimal, to detect damage; the prefix "2:"
/// distinguishes it from the checksum below.
std::string PolicyChecksum(const Policy::Parameters& parameters);
/// FNV-1a of the numbers alone, for older files whose checksum does not cover the metadata.
std::string NumbersChecksum(const Policy::Parameters& parameters);

inline constexpr char kMetricPrefix[] = "stg.metric.";

}  // namespace stg::agent

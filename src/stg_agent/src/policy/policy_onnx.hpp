#pragma once

#include <onnx/onnx_pb.h>

#include <string>

#include "stg_agent/policy/policy.hpp"

/// Parts that the writers and the readers of policy files share.
namespace stg::agent {

/// Reads an ONNX file. Throws UserError with its name if it is not one, or too large for a policy.
onnx::ModelProto ReadModel(const std::string& path);

/// FNV-1a of the whole content of a policy file, hexadecimal, to detect damage; the prefix "2:"
/// distinguishes it from the checksum below.
std::string PolicyChecksum(const Policy::Parameters& parameters);
/// FNV-1a of the numbers alone, for older files whose checksum does not cover the metadata.
std::string NumbersChecksum(const Policy::Parameters& parameters);

inline constexpr char kMetricPrefix[] = "stg.metric.";

}  // namespace stg::agent

#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace stg::dynamics {

/// Bytes that a NetCDF classic file (CDF-1, 2 or 5) has at least, from the places of its variables
/// in its header: libnetcdf reads what is cut off as zeros. Nothing for files of other formats.
/// Throws UserError that names the file when the header cannot be read, or speaks of more names,
/// dimensions, attributes or variables than the file has bytes for, or of types and dimensions that
/// there are none of: libnetcdf takes memory for all that a header promises, and divides by the
/// size of a type that it does not know.
std::optional<std::uint64_t> SmallestClassicSize(const std::string& path);

}  // namespace stg::dynamics

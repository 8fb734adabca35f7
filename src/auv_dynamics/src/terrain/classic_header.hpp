#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace stg::dynamics {

/// Bytes that a NetCDF classic file (CDF-1, 2 or 5) has at least, from the places of its variables
/// in its header: libnetcdf reads what is cut off as zeros. Nothing for files of other formats and
/// for headers that cannot be read, of which libnetcdf itself complains.
std::optional<std::uint64_t> SmallestClassicSize(const std::string& path);

}  // namespace stg::dynamics

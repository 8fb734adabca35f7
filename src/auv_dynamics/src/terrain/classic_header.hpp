#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace stg::dynamics {

/// Smallest possible size in bytes of a NetCDF classic file (CDF-1, 2 or 5), from the places of the
/// variables in its header; nothing for other formats. It is needed because libnetcdf reads missing
/// bytes at the end as zeros. Throws UserError that names the file if the header cannot be read, or
/// if it states more names, dimensions, attributes or variables than the file has bytes for, or
/// unknown types or dimensions. libnetcdf would allocate memory for everything in the header, and
/// would divide by the size of an unknown type.
std::optional<std::uint64_t> SmallestClassicSize(const std::string& path);

}  // namespace stg::dynamics

#pragma once

#include <cstddef>

namespace stg::nodes {

/// Bytes that a node may have; it needs some tens of megabytes.
inline constexpr std::size_t kNodeMemory = std::size_t{2} << 30;

/// Limits the memory of this process. roscpp makes room for as many elements as a message says that
/// it has, before anybody can check it: with a limit such a message is an error that roscpp catches
/// and logs, and not the end of the machine.
void LimitMemory(std::size_t bytes);

}  // namespace stg::nodes

#pragma once

#include <cstddef>

namespace stg::nodes {

/// Memory limit of a node in bytes. A node needs some tens of megabytes.
inline constexpr std::size_t kNodeMemory = std::size_t{2} << 30;

/// Limits the memory of this process. roscpp reserves memory for the number of elements that a
/// message states, before anything can check the number. With a limit, a wrong number is an error
/// that roscpp catches and logs; without it, the machine may run out of memory.
void LimitMemory(std::size_t bytes);

/// Returns free memory, and pages of programs and libraries that equal their files, to the system.
/// A node needs much more memory while it reads its configuration than afterwards.
void ReturnFreeMemory();

}  // namespace stg::nodes

#include "auv_common/nodes/memory_limit.hpp"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>

namespace stg::nodes {

void LimitMemory(std::size_t bytes) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  (void)bytes;  // sanitizers reserve terabytes of addresses
#else
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, bytes);
  setrlimit(RLIMIT_DATA, &limit);
#endif
}

void ReturnFreeMemory() { malloc_trim(0); }

}  // namespace stg::nodes
